#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and tables of docs/benchmarks.md from the CSV that build_bench prints.

    plot_builds.py [CSV...] [--page FILE] [--pictures FOLDER] [--check]

Every model gets a picture (error against spheres, error against seconds, both log-log) and a table, which
replace what stands between the two marks in the page. Several CSV files count as one. --check writes nothing
and ends with code 1 when the page or a picture is not what the CSV makes of it. Standard library only.
"""
import argparse
import csv
import math
import sys
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).resolve().parents[2]
BEGIN = "<!-- begin: made by tests/bench/plot_builds.py -->"
END = "<!-- end -->"

# Series in the order of legends, with marker and colours in light and dark. Baselines are grey, the reducers
# of the medial axis have a hue each, the refined trees share one.
STYLES = {
    "octree": ("triangle-down", "#8c959f", "#6e7681"),
    "grid": ("square", "#8c959f", "#6e7681"),
    "hubbard": ("diamond", "#59636e", "#9198a1"),
    "spawn": ("triangle", "#b35900", "#f0a04b"),
    "merge": ("square", "#1a7f37", "#4ac26b"),
    "burst": ("diamond", "#bf3989", "#f778ba"),
    "expand": ("triangle-down", "#9a6700", "#e3c04a"),
    "combined, not refined": ("cross", "#8250df", "#bc8cff"),
    "combined fast": ("triangle", "#54aeff", "#1f6feb"),
    "combined normal": ("circle", "#0969da", "#58a6ff"),
    "combined best": ("square", "#0a3069", "#b6daff"),
}
# For whatever else a file holds: another objective, a refined reducer, somebody else's trees.
SPARE_STYLES = [("circle", "#cf222e", "#ff7b72"), ("diamond", "#116329", "#7ee787"),
                ("triangle", "#7d4e00", "#d29922"), ("square", "#953800", "#ffa657")]
INK = ("#1f2328", "#e6edf3")
MUTED = ("#59636e", "#9198a1")
RULE = ("#d8dee4", "#30363d")
PAPER = ("#ffffff", "#0d1117")

WIDTH, HEIGHT = 860, 470
TOP, BOTTOM = 56, 330  # of the panels
PANELS = [(64, 410), (494, 840)]
MARKER = 4.5
LEGEND_COLUMNS, LEGEND_ROW = 4, 22


class Row:
    """One level of one build. `seconds` are those of the whole build, by number of threads."""

    def __init__(self, cells, usual_reducers):
        self.model = cells["model"]
        self.triangles = int(cells["triangles"])
        self.series = series_of(cells, usual_reducers)
        self.level = int(cells["level"])
        self.spheres = int(cells["spheres"])
        self.worst = float(cells["worst"])
        self.mean = float(cells["mean"])
        self.volume_ratio = float(cells["volume_ratio"])
        self.covered = cells["covered"] == "yes"
        self.hash = cells["tree_hash"]
        self.seconds = {}

    @property
    def time(self):
        """What builds are compared by: of the fewest threads, and no less than a millisecond."""
        return max(self.seconds[min(self.seconds)], 1e-3)


def series_of(cells, usual_reducers):
    """The name under which a build appears: what distinguishes it from what its builder usually does."""
    builder, refined, linked = cells["builder"], cells["refine"] == "on", cells["link"] == "on"
    if builder == "combined":
        name = "combined " + cells["quality"] if refined else "combined, not refined"
        if cells["reducers"] != usual_reducers:
            name += " of " + cells["reducers"]
        if refined and not linked:
            name += ", not linked"
    else:
        name = builder
        if refined:
            name += ", refined " + cells["quality"] + (", linked" if linked else "")
    if cells["objective"] not in ("worst", "-"):
        name += ", least " + cells["objective"]
    return name


def read(paths):
    """Rows by model, in the order of the files, and the remarks at their heads."""
    models, remarks, usual = {}, [], None  # the reducers of the first combined are taken for the usual ones
    for path in paths:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line]
        remarks += [line[2:] for line in lines if line.startswith("# ") and line[2:] not in remarks]
        lines = [line for line in lines if not line.startswith("#")]
        # A file may be several runs, one after the other.
        for cells in csv.DictReader(line for i, line in enumerate(lines) if i == 0 or line != lines[0]):
            if usual is None and cells["builder"] == "combined":
                usual = cells["reducers"]
            row = Row(cells, usual)
            rows = models.setdefault(row.model, {})
            row = rows.setdefault((row.series, row.level), row)
            if row.hash != cells["tree_hash"]:
                sys.exit(f"{path}: two trees of {row.series} for {row.model}: {row.hash}, {cells['tree_hash']}")
            row.seconds[int(cells["threads"])] = float(cells["build_seconds"])
    return {model: list(rows.values()) for model, rows in models.items()}, remarks


def unbeaten(row, rows):
    """Whether no other row of the level has as few spheres, as little error and as little time at once."""
    def beats(other):
        mine, theirs = (row.spheres, row.worst, row.time), (other.spheres, other.worst, other.time)
        return theirs != mine and all(a <= b for a, b in zip(theirs, mine))
    return not any(beats(other) for other in rows if other.level == row.level)


def series_in_order(rows):
    names = list(dict.fromkeys(row.series for row in rows))
    known = [name for name in STYLES if name in names]
    return known + [name for name in names if name not in STYLES]


def style_of(name, names):
    if name in STYLES:
        return STYLES[name]
    others = [other for other in names if other not in STYLES]
    return SPARE_STYLES[others.index(name) % len(SPARE_STYLES)]


# --- pictures ---


class Axis:
    """A logarithmic axis from the smallest to the largest value, with a little room at both ends."""

    def __init__(self, values, begin, end):
        low, high = math.log10(min(values)), math.log10(max(values))
        room = max(0.05 * (high - low), 0.05)
        self.low, self.high = low - room, high + room
        self.begin, self.end = begin, end

    def at(self, value):
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.begin + share * (self.end - self.begin)

    def ticks(self):
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        for mantissas in ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7)):
            ticks = [m * 10.0 ** d for d in decades for m in mantissas]
            ticks = [tick for tick in ticks if self.low <= math.log10(tick) <= self.high]
            if len(ticks) >= 4:
                break
        return ticks


def number(value):
    return f"{value:.2f}".rstrip("0").rstrip(".")


def tick_text(value):
    return f"{value:.10g}"


class Drawing:
    """Colours are attributes, for viewers without style sheets, and rules for those that prefer dark."""

    def __init__(self, title):
        self.rules = {}
        self.parts = []
        self.title = title

    def paint(self, kind, colours):
        light, dark = colours
        name = f"{kind[0]}{light[1:]}"
        self.rules[name] = f".{name}{{{kind}:{dark}}}"
        return f'class="{name}" {kind}="{light}"'

    def text(self, x, y, content, colours=INK, anchor="start", size=12, extra=""):
        self.parts.append(f'<text x="{number(x)}" y="{number(y)}" text-anchor="{anchor}" font-size="{size}" '
                          f'{self.paint("fill", colours)}{extra}>{escape(content)}</text>')

    def line(self, points, colours, width, dash=""):
        path = " ".join(f"{number(x)},{number(y)}" for x, y in points)
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<polyline points="{path}" fill="none" stroke-width="{width}"{dashes} '
                          f'{self.paint("stroke", colours)}/>')

    def marker(self, x, y, shape, colours):
        r = MARKER
        outlines = {
            "square": [(-r, -r), (r, -r), (r, r), (-r, r)],
            "diamond": [(0, -1.3 * r), (1.3 * r, 0), (0, 1.3 * r), (-1.3 * r, 0)],
            "triangle": [(0, -1.25 * r), (1.2 * r, 0.9 * r), (-1.2 * r, 0.9 * r)],
            "triangle-down": [(0, 1.25 * r), (1.2 * r, -0.9 * r), (-1.2 * r, -0.9 * r)],
        }
        if shape == "cross":
            self.line([(x - r, y - r), (x + r, y + r)], colours, 2.5)
            self.line([(x - r, y + r), (x + r, y - r)], colours, 2.5)
            return
        fill = self.paint("fill", colours)
        if shape == "circle":
            self.parts.append(f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(1.1 * r)}" {fill}/>')
            return
        path = " ".join(f"{number(x + dx)},{number(y + dy)}" for dx, dy in outlines[shape])
        self.parts.append(f'<polygon points="{path}" {fill}/>')

    def svg(self, height):
        paper = self.paint("fill", PAPER)
        rules = "".join(self.rules[name] for name in sorted(self.rules))
        return "\n".join([
            "<!-- SPDX-License-Identifier: GPL-3.0-or-later; made by tests/bench/plot_builds.py -->",
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" '
            f'height="{height}" font-family="system-ui, sans-serif" role="img">',
            f"<title>{escape(self.title)}</title>",
            f"<style>@media (prefers-color-scheme: dark){{{rules}}}</style>",
            f'<rect width="{WIDTH}" height="{height}" {paper}/>',
            *self.parts,
            "</svg>",
            ""])


def draw_frame(drawing, x_axis, y_axis, title, x_title):
    for tick in x_axis.ticks():
        x = x_axis.at(tick)
        drawing.line([(x, TOP), (x, BOTTOM)], RULE, 1)
        drawing.text(x, BOTTOM + 16, tick_text(tick), MUTED, "middle", 11)
    for tick in y_axis.ticks():
        y = y_axis.at(tick)
        drawing.line([(x_axis.begin, y), (x_axis.end, y)], RULE, 1)
        drawing.text(x_axis.begin - 6, y + 4, tick_text(tick), MUTED, "end", 11)
    drawing.text(x_axis.begin, TOP - 10, title, INK, "start", 12)
    drawing.text((x_axis.begin + x_axis.end) / 2, BOTTOM + 34, x_title, MUTED, "middle", 12)


def draw_series(drawing, points, style):
    shape, *colours = style
    if len(points) > 1:
        drawing.line(points, colours, 1.5)
    for x, y in points:
        drawing.marker(x, y, shape, colours)


def draw_front(drawing, rows, x_axis, y_axis):
    """The staircase below which there is no tree: less error costs more time."""
    points, best = [], math.inf
    for row in sorted(rows, key=lambda r: (r.time, r.worst)):
        if row.worst >= best:
            continue
        x, y = x_axis.at(row.time), y_axis.at(100 * row.worst)
        if points:
            points.append((x, points[-1][1]))
        points.append((x, y))
        best = row.worst
    if len(points) > 1:
        drawing.line(points, MUTED, 1, "3 3")


def draw_legend(drawing, names):
    for k, name in enumerate(names):
        x = PANELS[0][0] + (k % LEGEND_COLUMNS) * (PANELS[1][1] - PANELS[0][0]) / LEGEND_COLUMNS
        y = BOTTOM + 66 + (k // LEGEND_COLUMNS) * LEGEND_ROW
        shape, *colours = style_of(name, names)
        drawing.line([(x, y), (x + 22, y)], colours, 1.5)
        drawing.marker(x + 11, y, shape, colours)
        drawing.text(x + 29, y + 4, name)


def picture(model, rows):
    rows = [row for row in rows if row.level > 0]
    names = series_in_order(rows)
    last = {}
    for row in sorted(rows, key=lambda r: r.level):
        last[row.series] = row
    threads = min(min(row.seconds) for row in rows)
    drawing = Drawing(f"{model}: worst overhang against spheres and against build seconds")
    y_axis = Axis([100 * row.worst for row in rows], BOTTOM, TOP)
    spheres = Axis([row.spheres for row in rows], *PANELS[0])
    seconds = Axis([row.time for row in last.values()], *PANELS[1])
    drawing.text(PANELS[0][0], 22, f"{model}: worst overhang, % of the diagonal", INK, "start", 15,
                 ' font-weight="600"')
    drawing.text(PANELS[1][1], 22, f"{rows[0].triangles} triangles", MUTED, "end", 12)
    draw_frame(drawing, spheres, y_axis, "against spheres, a point per level", "spheres")
    draw_frame(drawing, seconds, y_axis, "last level, against the build of the whole tree",
               f"seconds, {threads} thread{'s' if threads > 1 else ''}")
    draw_front(drawing, last.values(), seconds, y_axis)
    for name in names:
        mine = sorted((row for row in rows if row.series == name), key=lambda r: r.level)
        style = style_of(name, names)
        draw_series(drawing, [(spheres.at(r.spheres), y_axis.at(100 * r.worst)) for r in mine], style)
        draw_series(drawing, [(seconds.at(last[name].time), y_axis.at(100 * last[name].worst))], style)
    draw_legend(drawing, names)
    legend_rows = (len(names) + LEGEND_COLUMNS - 1) // LEGEND_COLUMNS
    return drawing.svg(BOTTOM + 66 + legend_rows * LEGEND_ROW)


# --- page ---


def seconds_text(value):
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 100 else f"{value:.0f}"


def cell(row, rows):
    text = f"{row.spheres}: {100 * row.worst:.2f} / {100 * row.mean:.2f} / {row.volume_ratio:.3f}"
    if not row.covered:
        text += " (not covered)"
    return f"**{text}**" if unbeaten(row, rows) else text


def table(model, rows):
    levels = sorted({row.level for row in rows if row.level > 0})
    threads = sorted({n for row in rows for n in row.seconds})
    head = ["builder"] + [f"s, {n} thread{'s' if n > 1 else ''}" for n in threads] + \
           [f"level {level}" for level in levels]
    lines = ["| " + " | ".join(head) + " |",
             "| --- | " + " | ".join(["--:"] * len(threads) + ["---"] * len(levels)) + " |"]
    found = {(row.series, row.level): row for row in rows}
    for name in series_in_order(rows):
        first = found[name, 0] if (name, 0) in found else next(r for r in rows if r.series == name)
        cells = [name] + [seconds_text(first.seconds[n]) if n in first.seconds else "" for n in threads]
        cells += [cell(found[name, level], rows) if (name, level) in found else "" for level in levels]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def generated(models, remarks, pictures_from_page):
    parts = [BEGIN, ""]
    parts += [f"* {remark}" for remark in remarks]
    for model, rows in models.items():
        parts += ["", f"### {model}, {rows[0].triangles} triangles", "",
                  f"![{model}: error against spheres and against seconds]({pictures_from_page}/{file_name(model)})",
                  "", table(model, rows)]
    return "\n".join(parts + ["", END])


def file_name(model):
    return f"builds-{model}.svg"


def with_block(page, block):
    begin, end = page.index(BEGIN), page.index(END)
    return page[:begin] + block + page[end + len(END):]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("csv", nargs="*", type=Path, default=[ROOT / "tests/bench/results/builds.csv"])
    parser.add_argument("--page", type=Path, default=ROOT / "docs/benchmarks.md")
    parser.add_argument("--pictures", type=Path, default=ROOT / "docs/pictures")
    parser.add_argument("--check", action="store_true", help="write nothing, say what differs")
    options = parser.parse_args()

    models, remarks = read(options.csv)
    page = options.page.read_text(encoding="utf-8")
    outputs = {options.page: with_block(page, generated(models, remarks, options.pictures.name))}
    for model, rows in models.items():
        outputs[options.pictures / file_name(model)] = picture(model, rows)
    stale = [path for path, text in outputs.items()
             if not path.exists() or path.read_text(encoding="utf-8") != text]
    for path in stale:
        if not options.check:
            path.write_text(outputs[path], encoding="utf-8")
        print(("differs: " if options.check else "wrote ") + str(path))
    return 1 if options.check and stale else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except OSError as failure:
        sys.exit(f"plot_builds.py: {failure}")
