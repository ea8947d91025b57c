#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# room.sh CROWDED_ROOM TREES: draws the pictures of docs/crowded-room.md and the README, off-screen, into the folder of
# this script. TREES holds bunny-1500.sph, bunny-1500.obj and box.sph (levels 2). Needs ffmpeg and pngquant.
set -euo pipefail

program=$(realpath "${1:?usage: room.sh CROWDED_ROOM TREES}")
trees=$(realpath "${2:?usage: room.sh CROWDED_ROOM TREES}")
cd "$(dirname "${BASH_SOURCE[0]}")"
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

shoot() { "$program" --trees "$trees" --smooth 4 "$@" >/dev/null; }
small() { pngquant --force --quality 70-95 --output "$2" "$1"; }

# The room in play, with its panel; the stick is flown by the program.
shoot --tour --panel --objects 1500 --seed 2 --frames 252 --size 1200x720 --screenshot "$work/play.png"
small "$work/play.png" room.png

# One moment four times: meshes, balls of two levels, overhang.
moment=(--tour --objects 1500 --seed 2 --frames 252 --size 600x360)
shoot "${moment[@]}" --screenshot "$work/a.png"
shoot "${moment[@]}" --look balls --levels 2 --screenshot "$work/b.png"
shoot "${moment[@]}" --look balls --levels 3 --screenshot "$work/c.png"
shoot "${moment[@]}" --look balls --levels 3 --paint overhang --screenshot "$work/d.png"
ffmpeg -loglevel error -y -i "$work/a.png" -i "$work/b.png" -i "$work/c.png" -i "$work/d.png" \
  -filter_complex '[0][1]hstack[top];[2][3]hstack[low];[top][low]vstack' "$work/looks.png"
small "$work/looks.png" room-looks.png

# 4000 objects from outside, as in the paper's largest scene.
shoot --view room --objects 4000 --frames 90 --size 1200x640 --screenshot "$work/outside.png"
small "$work/outside.png" room-outside.png

# Three seconds of flight, twelve pictures a second.
shoot --tour --objects 1500 --seed 2 --frames 180 --every 5 --size 400x240 --record "$work/film"
ffmpeg -loglevel error -y -framerate 12 -i "$work/film/%05d.png" \
  -vf 'split[a][b];[a]palettegen=max_colors=72[p];[b][p]paletteuse=dither=none:diff_mode=rectangle' room.gif
