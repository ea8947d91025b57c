// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include <spheretree/result.hpp>

#include "io/files.hpp"
#include "medial/triangle_mesh.hpp"

namespace spheretree::io {

/// Writes OBJ, OFF, PLY (binary) or STL (binary) by the file's extension. Text carries 17 digits, so OBJ and
/// OFF read back bit for bit. Errors: InvalidArgument (unknown extension), UnwritableOutput.
Result<Done> writeMesh(const std::filesystem::path& path, const medial::TriangleMesh& mesh,
                       Overwrite overwrite);

}  // namespace spheretree::io
