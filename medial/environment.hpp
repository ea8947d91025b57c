// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spheretree::medial {

/// Starts the program anew, once, with what the system's libraries read before main() runs:
///   * OMP_WAIT_POLICY=passive. Threads that wait for each other sleep; if they kept their processors busy,
///     two threads on a machine with something else to do would be slower than one.
///   * GLIBC_TUNABLES for large pages behind the heap, and for keeping what is freed: a build allocates much
///     and for short times, a fifth of it would be page faults.
/// What the user has set stays, and setting OMP_WAIT_POLICY prevents all of it. For programs, first thing in
/// main(): a library leaves its host alone. Does nothing where this cannot be done (Linux can).
void tuneEnvironment(char** argv);

}  // namespace spheretree::medial
