#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the manual page docs/man/spheretree.1 from what the program says of itself.

make_man.py PROGRAM            rewrites the page
make_man.py PROGRAM --check    fails when the page is not what would be written
"""
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).parent / "spheretree.1"


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def escaped(text):
    """Text for troff: hyphens of options are minus signs, and no line begins a request."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.M)


def entries(lines):
    """(left, right) of each option; the right part may begin on the next line."""
    found = []
    for line in lines:
        if not line.strip():
            continue
        if line.startswith("   "):
            found[-1][1] += (" " if found[-1][1] else "") + line.strip()
        else:
            left, _, right = line.strip().partition("  ")
            found.append([left, right.strip()])
    return found


def parts(help_text):
    """(title, lines) of the parts of a help: those before the first title belong to None."""
    title, lines = None, []
    for line in help_text.splitlines():
        if re.match(r"^[A-Z][A-Za-z ]*:$", line):
            yield title, lines
            title, lines = line[:-1], []
        elif title and line and not line.startswith(" "):
            yield title, lines
            title, lines = "", [line]
        else:
            lines.append(line)
    yield title, lines


def subcommand(program, name, purpose):
    page = [".SS %s" % name, escaped(purpose) + "."]
    for title, lines in parts(output_of(program, name, "--help")):
        if title is None:
            usage = [line for line in lines if line.startswith("Usage:")]
            page += [".PP", ".B " + escaped(usage[0].split(": ", 1)[1])]
        elif title == "":
            text = " ".join(line.strip() for line in lines if line.strip())
            page += [".PP", escaped(text)]
        else:
            page += [".PP", ".I %s" % title]
            for left, right in entries(lines):
                page += [".TP", ".B " + escaped(left), escaped(right) if right else "\\&"]
    return page


def make(program):
    text = output_of(program, "--help")
    version = output_of(program, "--version").split()[1]
    commands = []
    footer = []
    for title, lines in parts(text):
        if title == "Subcommands":
            commands = entries(lines)
        if title == "":
            footer += lines
    page = [
        '.\\" SPDX-License-Identifier: GPL-3.0-or-later',
        '.\\" Made by docs/man/make_man.py from the help of the program.',
        '.TH SPHERETREE 1 "" "spheretree %s" "User Commands"' % version,
        ".SH NAME",
        "spheretree \\- turns triangle meshes into sphere trees, and measures them",
        ".SH SYNOPSIS",
        ".B spheretree",
        ".I SUBCOMMAND",
        "[options]",
        ".SH SUBCOMMANDS",
    ]
    for name, purpose in commands:
        page += subcommand(program, name, purpose)
    page += [".SH EXIT STATUS", escaped(" ".join(line.strip() for line in footer if line.strip()))]
    page += [".SH SEE ALSO", "The book of spheretree, docs/README.md in the sources."]
    return "\n".join(page) + "\n"


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    page = make(sys.argv[1])
    if "--check" not in sys.argv:
        PAGE.write_text(page)
    elif PAGE.read_text() != page:
        sys.exit("docs/man/spheretree.1 is not what the program says of itself: docs/man/make_man.py rewrites it")


if __name__ == "__main__":
    main()
