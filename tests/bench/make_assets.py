#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a folder of 500 assets for `spheretree batch`: what a studio's library looks like, broken files included.

make_assets.py MAKE_MODELS OUT [--packages DIR] [--count 500]

The meshes of Debian's packages libcgal-demo and assimp-testmodels are taken as they are (DIR is where they were
unpacked, / when they are installed); the models of models/make_models, stretched, twisted, cut short and written
in four formats, fill up what is missing. The same arguments give the same files.
"""
import argparse
import math
import pathlib
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile

ENDINGS = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".dae", ".3ds", ".fbx"}
CGAL_ARCHIVES = "usr/share/doc/libcgal-dev"
ASSIMP_FOLDER = "usr/share/assimp/models"
BROKEN_EVERY = 12  # one generated asset in so many is damaged


def read_obj(path):
    points, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(word.split("/")[0]) - 1 for word in words[1:]])
    return points, faces


def varied(points, k):
    """Stretched along two axes, twisted about the third."""
    sx, sy, twist = 1 + 0.25 * (k % 5), 1 + 0.4 * (k % 3), 0.3 * (k % 4)
    moved = []
    for x, y, z in points:
        x, y = x * sx, y * sy
        turn = twist * z
        moved.append([x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), z])
    return moved


def triangles(faces):
    for face in faces:
        for k in range(1, len(face) - 1):
            yield face[0], face[k], face[k + 1]


def as_obj(points, faces):
    lines = ["v %.9g %.9g %.9g" % tuple(p) for p in points]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces]
    return ("\n".join(lines) + "\n").encode()


def as_off(points, faces):
    lines = ["OFF", "%d %d 0" % (len(points), len(faces))]
    lines += ["%.9g %.9g %.9g" % tuple(p) for p in points]
    lines += ["%d " % len(face) + " ".join(map(str, face)) for face in faces]
    return ("\n".join(lines) + "\n").encode()


def as_ply(points, faces):
    head = ("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(points), len(faces)))
    body = ["%.9g %.9g %.9g" % tuple(p) for p in points]
    body += ["%d " % len(face) + " ".join(map(str, face)) for face in faces]
    return (head + "\n".join(body) + "\n").encode()


def as_stl(points, faces):
    corners = list(triangles(faces))
    text = b"\0" * 80 + struct.pack("<I", len(corners))
    for corner in corners:
        text += struct.pack("<12fH", 0, 0, 0, *(c for v in corner for c in points[v]), 0)
    return text


FORMATS = [(".obj", as_obj), (".off", as_off), (".ply", as_ply), (".stl", as_stl)]


def damaged(data, k):
    """What goes wrong in a library: a file cut short, an empty one, one of another kind."""
    return [data[:len(data) // 2], b"", b"<html>404 not found</html>\n", data[len(data) // 3:]][k % 4]


def generate(make_models, out, count):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([make_models, "-o", folder], check=True, stdout=subprocess.DEVNULL)
        models = sorted(pathlib.Path(folder).glob("*.obj"))
        for number in range(count):
            k, path = number // len(models), models[number % len(models)]
            points, faces = read_obj(path)
            ending, write = FORMATS[number % len(FORMATS)]
            data = write(varied(points, k), faces)
            if number % BROKEN_EVERY == BROKEN_EVERY - 1:
                data = damaged(data, number // BROKEN_EVERY)
            target = out / "generated" / path.stem / ("%s_%02d%s" % (path.stem, k, ending))
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)


def collect(root, out):
    """Copies the meshes of the packages, and what stands beside them."""
    found = 0
    assimp = root / ASSIMP_FOLDER
    for path in sorted(assimp.rglob("*")):
        if not path.is_file() or path.suffix.lower() not in ENDINGS | {".bin"}:
            continue
        target = out / "assimp" / path.relative_to(assimp)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        found += path.suffix.lower() in ENDINGS
    for archive in sorted((root / CGAL_ARCHIVES).glob("d*.tar.gz")):
        with tarfile.open(archive) as tar:
            for member in tar:
                name = pathlib.PurePosixPath(member.name)
                if not member.isfile() or name.suffix.lower() not in ENDINGS or ".." in name.parts:
                    continue
                target = out / "cgal" / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(tar.extractfile(member).read())
                found += 1
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("make_models")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--packages", type=pathlib.Path, default=pathlib.Path("/"))
    parser.add_argument("--count", type=int, default=500)
    options = parser.parse_args()
    if options.out.exists():
        sys.exit("make_assets.py: %s exists already" % options.out)
    found = collect(options.packages, options.out)
    generate(options.make_models, options.out, max(options.count - found, 0))
    print("%d of Debian's packages, %d generated" % (found, max(options.count - found, 0)))


if __name__ == "__main__":
    main()
