#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and tables of docs/experiments.md from what run_experiments.sh measured.

    plot_experiments.py [--results FOLDER] [--page FILE] [--pictures FOLDER] [--check]
    plot_experiments.py --collect FOLDER [--results FOLDER]

Reads experiments.csv, experiments-parts.csv and, if it is there, experiments-rendered.csv, and replaces what
stands between the two marks in the page. --check writes nothing and ends with code 1 when the page or a picture
is not what the tables make of it. --collect makes experiments-rendered.csv of the JSON reports that
`crowded_room --render` wrote. Frame rates are 1 / median, not 1 / mean as in the paper: on a machine that others
use, the mean says how often they came in between; of long frames the processor's time says more than the clock. Standard library only.
"""
import argparse
import csv
import json
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # nothing is to be left beside the sources
from plot_builds import BOTTOM, INK, MUTED, PANELS, ROOT, TOP, Axis, Drawing, draw_frame, draw_series  # noqa: E402

BEGIN = "<!-- begin: made by tests/bench/plot_experiments.py -->"
END = "<!-- end -->"
RUNS, PARTS, RENDERED = "experiments.csv", "experiments-parts.csv", "experiments-rendered.csv"
RENDERED_COLUMNS = ["objects", "levels", "frames", "collision_median", "step_processor_median", "render_median",
                    "render_processor_median"]

# Marker, colour in light and dark.
STYLES = {
    "brute force": ("cross", "#8c959f", "#6e7681"),
    "octree": ("triangle-down", "#b35900", "#f0a04b"),
    "grid": ("square", "#1a7f37", "#4ac26b"),
    "grid with sweep & prune": ("diamond", "#116329", "#7ee787"),
    "sweep & prune": ("circle", "#bf3989", "#f778ba"),
    "sweep": ("circle", "#0969da", "#58a6ff"),
    "grid chosen": ("square", "#59636e", "#9198a1"),
    "octree 4 levels": ("triangle-down", "#b35900", "#f0a04b"),
    "octree 5 levels": ("triangle", "#9a6700", "#e3c04a"),
    "combined 2 levels": ("diamond", "#0969da", "#58a6ff"),
    "combined 3 levels": ("circle", "#0a3069", "#b6daff"),
    "sweep & prune: update": ("circle", "#bf3989", "#f778ba"),
    "sweep & prune: pairs": ("diamond", "#cf222e", "#ff7b72"),
    "grid: update": ("square", "#1a7f37", "#4ac26b"),
    "grid: pairs": ("triangle", "#116329", "#7ee787"),
    "boxes moved": ("square", "#59636e", "#9198a1"),
    "update": ("circle", "#bf3989", "#f778ba"),
    "broad phase": ("diamond", "#cf222e", "#ff7b72"),
    "narrow phase": ("triangle", "#0969da", "#58a6ff"),
    "boxes as combined trees": ("circle", "#0969da", "#58a6ff"),
    "exact boxes": ("square", "#8250df", "#bc8cff"),
    "boxes as octrees": ("triangle-down", "#b35900", "#f0a04b"),
    "broad phase only": ("diamond", "#59636e", "#9198a1"),
}
LEGEND_ROW = 22
FIRST, HALF, FULL = 100, 500, 1000  # objects in the tables


class Tables:
    """Everything that was measured: runs by experiment, series and objects; parts by quantity, too."""

    def __init__(self, folder):
        self.remarks, rows = self.read(folder / RUNS)
        self.runs = {(r["experiment"], r["series"], int(r["objects"])): r for r in rows}
        parts = self.read(folder / PARTS)[1]
        self.parts = {(r["experiment"], r["series"], int(r["objects"]), r["quantity"]): float(r["value"])
                      for r in parts}
        rendered = folder / RENDERED
        self.rendered = self.read(rendered)[1] if rendered.exists() else []

    @staticmethod
    def read(path):
        lines = path.read_text(encoding="utf-8").splitlines()
        remarks = [line[2:] for line in lines if line.startswith("# ")]
        return remarks, list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def value(self, experiment, series, objects, column):
        return float(self.runs[experiment, series, objects][column])

    def spent(self, experiment, series, objects):
        """Microseconds of collision: the wall clock counts interruptions, the processor's time the response."""
        columns = "collision_median", "processor_median"
        return min(self.value(experiment, series, objects, column) for column in columns)

    def fps(self, experiment, series, objects):
        return 1e6 / self.spent(experiment, series, objects)

    def series(self, experiment):
        return list(dict.fromkeys(series for name, series, _ in self.runs if name == experiment))

    def counts(self, experiment):
        return sorted({objects for name, _, objects in self.runs if name == experiment})

    def part(self, experiment, series, objects, quantity):
        return self.parts[experiment, series, objects, quantity]

    def part_counts(self, experiment):
        return sorted({objects for name, _, objects, _ in self.parts if name == experiment})


# --- words for numbers ---


def rate(fps):
    """Frame rates are rounded to three digits: more would be noise."""
    return f"{float(f'{fps:.3g}'):,.0f}"


def time(microseconds):
    if microseconds >= 1000:
        return f"{microseconds / 1000:.3g} ms"
    return f"{microseconds:.3g} µs"


def times(ratio):
    return f"{ratio:.2f}" if ratio < 10 else f"{ratio:.0f}"


def percent(share):
    return f"{100 * share:.0f} %"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "| --- | " + " | ".join(["--:"] * (len(head) - 1)) + " |"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


# --- pictures ---


class Picture:
    """Two panels of curves over the number of objects, both axes logarithmic, one legend under each."""

    def __init__(self, title):
        self.drawing = Drawing(title)
        self.rows = 0

    def panel(self, place, title, unit, curves, level=None):
        """`curves` maps the name of a series to points; `level` is a value and a word for a dotted line."""
        begin, end = PANELS[place]
        points = [point for curve in curves.values() for point in curve]
        heights = [y for _, y in points] + ([level[0]] if level else [])
        x_axis, y_axis = Axis([x for x, _ in points], begin, end), Axis(heights, BOTTOM, TOP)
        draw_frame(self.drawing, x_axis, y_axis, f"{title}: {unit}", "objects")
        if level:
            y = y_axis.at(level[0])
            self.drawing.line([(begin, y), (end, y)], MUTED, 1, "3 3")
            self.drawing.text(begin + 4, y - 5, level[1], MUTED, "start", 11)
        for row, (name, curve) in enumerate(curves.items()):
            draw_series(self.drawing, [(x_axis.at(x), y_axis.at(y)) for x, y in curve], STYLES[name])
            self.legend(begin, BOTTOM + 60 + row * LEGEND_ROW, name)
        self.rows = max(self.rows, len(curves))

    def legend(self, x, y, name):
        shape, *colours = STYLES[name]
        self.drawing.line([(x, y), (x + 22, y)], colours, 1.5)
        self.drawing.marker(x + 11, y, shape, colours)
        self.drawing.text(x + 29, y + 4, name, INK)

    def svg(self):
        # The drawing names its maker.
        return self.drawing.svg(BOTTOM + 60 + self.rows * LEGEND_ROW).replace("plot_builds.py", "plot_experiments.py")


def rate_curves(tables, experiment, names=None):
    return {name: [(n, tables.fps(experiment, name, n)) for n in tables.counts(experiment)]
            for name in names or tables.series(experiment)}


def part_curves(tables, experiment, wanted):
    """`wanted` maps names to (series, quantity); zeros cannot be drawn on a logarithmic axis."""
    curves = {}
    for name, (series, quantity) in wanted.items():
        points = [(n, tables.part(experiment, series, n, quantity)) for n in tables.part_counts(experiment)]
        curves[name] = [(n, value) for n, value in points if value > 0]
    return curves


def picture_broad(tables):
    picture = Picture("Broad phases: collision frames per second over the number of objects")
    picture.panel(0, "Figure 4", "frames per second", rate_curves(tables, "figure-4"))
    picture.panel(1, "Figure 5", "frames per second", rate_curves(tables, "figure-5"))
    return picture.svg()


def picture_update(tables):
    picture = Picture("Where the time of a frame goes, over the number of objects")
    picture.panel(0, "Figure 6", "microseconds a frame",
                  part_curves(tables, "figure-6", {"sweep & prune: update": ("sweep & prune", "update"),
                                                   "sweep & prune: pairs": ("sweep & prune", "pairs"),
                                                   "grid: update": ("grid", "update"),
                                                   "grid: pairs": ("grid", "pairs")}))
    picture.panel(1, "Figure 8", "microseconds a frame",
                  part_curves(tables, "figure-8", {"update": ("sweep & prune", "update"),
                                                   "broad phase": ("sweep & prune", "pairs"),
                                                   "narrow phase": ("trees", "narrow"),
                                                   "boxes moved": ("boxes", "moved")}))
    return picture.svg()


def picture_trees(tables):
    picture = Picture("Sphere trees in the narrow phase, over the number of objects")
    picture.panel(0, "Figure 7, all phases", "frames per second", rate_curves(tables, "figure-7"))
    names = tables.series("figure-7")
    narrow = {name: [(n, tables.value("scaling", name, n, "narrow_median")) for n in tables.counts("scaling")]
              for name in names}
    picture.panel(1, "narrow phase alone", "microseconds a frame", narrow)
    return picture.svg()


def picture_rendered(tables):
    picture = Picture("Frames per second with rendering, over the number of objects")
    curves = {}
    for row in tables.rendered:
        curves.setdefault(f"combined {row['levels']} levels", []).append((int(row["objects"]), rendered_fps(row)))
    picture.panel(0, "Figure 9, with rendering", "frames per second", curves)
    picture.panel(1, "without rendering", "frames per second",
                  rate_curves(tables, "scaling", ["combined 2 levels", "combined 3 levels"]))
    return picture.svg()


def picture_own(tables):
    picture = Picture("Our own broad phase, and how the room scales")
    names = {"sweep": "sweep", "sweep & prune": "sweep_and_prune", "grid": "grid 10x4x10",
             "grid chosen": "grid chosen", "octree": "octree"}
    counts = tables.counts("broad-phases")
    picture.panel(0, "broad phases", "microseconds a frame",
                  {name: [(n, tables.spent("broad-phases", series, n)) for n in counts]
                   for name, series in names.items()})
    counts = tables.counts("own-scaling")
    picture.panel(1, "sweep and trees, one core", "processor time of a step, µs",
                  {name: [(n, tables.value("own-scaling", name, n, "processor_median")) for n in counts]
                   for name in ("boxes as combined trees", "exact boxes", "boxes as octrees", "broad phase only")},
                  (1e6 / 60, "60 frames per second"))
    return picture.svg()


# --- the page ---


def rendered_fps(row):
    """By processor time: what one core alone would reach."""
    return 1e6 / (float(row["step_processor_median"]) + float(row["render_processor_median"]))


def satisfaction(fps):
    return "high" if fps > 40 else "very good" if fps >= 26 else "good" if fps >= 10 else "low"


def verdict(holds):
    return "holds" if holds else "**does not hold**"


def shares(tables, series):
    values = []
    for n in tables.part_counts("figure-6"):
        update, pairs = (tables.part("figure-6", series, n, what) for what in ("update", "pairs"))
        values.append(update / (update + pairs))
    return f"{percent(min(values))} to {percent(max(values))}"


def faster(measure, one, other):
    """By what share `one` is faster than `other`."""
    return measure(other) / measure(one) - 1


def statements_broad(t):
    grid, octree, brute = (t.fps("figure-4", name, HALF) for name in ("grid", "octree", "brute force"))
    plain = {name: t.fps("figure-5", name, FULL) for name in t.series("figure-5")}
    sap, of_grid = plain["sweep & prune"], plain["grid"]
    hybrid = plain["grid with sweep & prune"]
    similar = [t.fps("movements", f"{name} xz", FULL) / t.fps("movements", f"{name} xyz", FULL)
               for name in ("grid", "octree", "sweep_and_prune")]
    return [
        ("500 boxes: the grid is faster than the octree", "34 and 12 fps, 2.8 times",
         f"{rate(grid)} and {rate(octree)} fps, {times(grid / octree)} times", verdict(grid > octree)),
        ("500 boxes: both are faster than brute force", "figure only", f"brute force: {rate(brute)} fps",
         verdict(min(grid, octree) > brute)),
        ("1000 boxes: Sweep & Prune is faster than the grid", "54 and 14 fps, 3.9 times",
         f"{rate(sap)} and {rate(of_grid)} fps, {times(sap / of_grid)} times", verdict(sap > of_grid)),
        ("Sweep & Prune inside the voxels is slower than Sweep & Prune alone", "figures not given",
         f"{rate(hybrid)} and {rate(sap)} fps, {times(hybrid / sap)} times", verdict(hybrid < sap)),
        ("share of the structure update, Sweep & Prune", "78 to 98 %", shares(t, "sweep & prune"), ""),
        ("share of the structure update, grid", "53 to 62 %", shares(t, "grid"), ""),
        ("XZ and XYZ give similar results", "figures not given",
         f"XZ {min(similar):.2f} to {max(similar):.2f} times the rate of XYZ", verdict(0.5 < min(similar) and max(similar) < 2)),
    ]


def statements_trees(t):
    four, five = "octree 4 levels", "octree 5 levels"
    fine, coarse = "combined 3 levels", "combined 2 levels"
    most = max(t.counts("scaling"))
    rows = []
    for one, other, paper in ((four, five, "56 %"), (fine, four, "45 %")):
        whole = faster(lambda name: t.spent("figure-7", name, FULL), one, other)
        narrow = faster(lambda name: t.value("scaling", name, most, "narrow_median"), one, other)
        rows.append((f"{one} are faster than {other}", paper,
                     f"all phases, 1000 objects: {percent(whole)}; narrow phase alone, {most} objects: {percent(narrow)}",
                     verdict(narrow > 0)))
    stand = {name: last_stand_off(t, tree)
             for name, tree in ((four, "bunny-octree-4"), (five, "bunny-octree-5"), (coarse, "bunny-combined-2"),
                                (fine, "bunny-combined-3"))}
    rows.append(("trees of Combined are much more accurate", "pictures",
                 "balls stick out by at most " +
                 ", ".join(f"{percent(off)} ({name}, {balls} balls)" for name, (off, balls) in stand.items()) +
                 " of an object's edge", verdict(stand[fine][0] < stand[five][0] and stand[coarse][0] < stand[four][0])))
    update, pairs = (t.part("figure-8", "sweep & prune", FULL, what) for what in ("update", "pairs"))
    narrow = t.part("figure-8", "trees", FULL, "narrow")
    rows.append(("Sweep & Prune and Combined 2 levels: update > broad > narrow", "figure only",
                 f"1000 objects: {time(update)}, {time(pairs)}, {time(narrow)}", verdict(update > pairs > narrow)))
    return rows


def last_stand_off(t, tree):
    """How far the last level sticks out, and its balls."""
    levels = {quantity: (value, objects) for (name, series, objects, quantity), value in t.parts.items()
              if name == "trees" and series == tree and quantity.startswith("stand-off")}
    return levels[max(levels)]


def statements_scale(t):
    name = "combined 3 levels"
    few, many = t.fps("scaling", name, 2000), t.fps("scaling", name, 4000)
    rows = [("without rendering, from 2000 to 4000 objects", "9 to 2 fps, a ratio of 4.5",
             f"{rate(few)} to {rate(many)} fps, a ratio of {times(few / many)}", ""),
            ("Table 1: satisfaction is high to 350, very good to 500, good to 1000 objects", "with rendering",
             f"collisions alone: {satisfaction(many)} with 4000 objects, {rate(many)} fps", "")]
    drawn = {(int(row["objects"]), int(row["levels"])): rendered_fps(row) for row in t.rendered}
    if (FULL, 2) in drawn and (FULL, 3) in drawn:
        two, three = drawn[FULL, 2], drawn[FULL, 3]
        rows.append(("with rendering, 1000 objects: 2 levels are faster than 3", "14 and 12 fps",
                     f"{two:.3g} and {three:.3g} fps in software: {satisfaction(two)}", verdict(two > three)))
    else:
        rows.append(("with rendering, 1000 objects: 2 levels are faster than 3", "14 and 12 fps",
                     "not measured on this machine", ""))
    return rows


def rates_table(t, experiment, counts, extra=None):
    rows = []
    for name in t.series(experiment):
        cells = [rate(t.fps(experiment, name, n)) for n in counts]
        rows.append([name] + cells + ([extra(name)] if extra else []))
    return table(["frames per second"] + [f"{n:,} objects" for n in counts] +
                 (["narrow phase, 4,000 objects"] if extra else []), rows)


def split_table(t):
    rows = []
    for experiment, series, name in (("figure-6", "sweep & prune", "Figure 6, Sweep & Prune"),
                                     ("figure-6", "grid", "Figure 6, grid")):
        for n in (FIRST, HALF, FULL):
            update, pairs = (t.part(experiment, series, n, what) for what in ("update", "pairs"))
            rows.append([f"{name}, {n:,} objects", time(update), time(pairs), "", percent(update / (update + pairs))])
    for n in (FIRST, HALF, FULL):
        update, pairs = (t.part("figure-8", "sweep & prune", n, what) for what in ("update", "pairs"))
        narrow = t.part("figure-8", "trees", n, "narrow")
        rows.append([f"Figure 8, {n:,} objects", time(update), time(pairs), time(narrow),
                     percent(update / (update + pairs + narrow))])
    return table(["", "update", "broad phase", "narrow phase", "share of the update"], rows)


def rendered_table(t):
    rows = []
    for row in t.rendered:
        fps = rendered_fps(row)
        collision = float(row["collision_median"])
        rows.append([f"{int(row['objects']):,} objects, {row['levels']} levels", time(collision),
                     time(float(row["render_processor_median"])), f"{fps:.3g}", satisfaction(fps), satisfaction(1e6 / collision)])
    return table(["", "collisions", "rendering, processor time", "fps of one core", "satisfaction", "of the collisions alone"], rows)


def thousand_table(t):
    rows = []
    for name in t.series("thousand"):
        update, broad, narrow = (t.value("thousand", name, FULL, f"{phase}_median")
                                 for phase in ("update", "broad", "narrow"))
        whole = t.spent("thousand", name, FULL)
        rows.append([name, time(update), time(broad), time(narrow), time(whole), rate(1e6 / whole),
                     rate(1e6 / whole / 60)])
    return table(["1,000 objects", "update", "broad", "narrow", "all", "fps", "times 60 fps"], rows)


def scaling_table(t):
    counts = t.counts("own-scaling")
    rows = [[name] + [time(t.value("own-scaling", name, n, "processor_median")) for n in counts]
            for name in t.series("own-scaling")]
    rows.append(["pairs of boxes, boxes as combined trees"] +
                [f"{t.value('own-scaling', 'boxes as combined trees', n, 'pairs'):,.0f}" for n in counts])
    return table(["processor time of a step"] + [f"{n:,}" for n in counts], rows)


def capacity_table(t):
    rows = []
    for (experiment, series, objects), row in t.runs.items():
        if experiment == "capacity":
            rows.append([series, f"{objects:,}", time(float(row["processor_median"])), f"{float(row['pairs']):,.0f}",
                         f"{float(row['contacts']):,.0f}"])
    return table(["", "objects at 60 fps", "processor time of a step", "pairs", "contacts"], rows)


def proofs(t):
    lines = []
    for n in t.counts("same-state"):
        rows = [row for (name, _, objects), row in t.runs.items() if name == "same-state" and objects == n]
        hashes = {row["state_hash"] for row in rows}
        lines.append(f"* {n:,} objects, {rows[0]['frames']} frames: {len(rows)} runs, all broad phases with 1, 2 and 7 "
                     f"threads, {len(hashes)} state hash{'es' if len(hashes) > 1 else ''} (`{min(hashes)}`).")
    end = {quantity: value for (name, _, _, quantity), value in t.parts.items() if name == "endurance"}
    outside = sum(int(row["outside"]) for row in t.runs.values())
    changed = sum(int(row["changed_speeds"]) for row in t.runs.values())
    lines.append(f"* After {len(t.runs)} runs of this page: {outside} bodies outside the room, {changed} speeds changed.")
    if end:
        lines.append(
            f"* {end['steps']:,.0f} steps of 1,000 objects in {end['seconds']:,.0f} s with a restless stick: "
            f"{end['bodies outside in any step']:.0f} bodies outside the room in any step, "
            f"{end['speeds changed in any step']:.0f} velocity components of another magnitude, "
            f"{end['hits of the avatar']:,.0f} hits of the avatar; no two objects touched for longer than "
            f"{end['longest contact of a pair in steps']:.0f} steps; resident memory went from "
            f"{end['kilobytes after 1 % of the steps']:,.0f} to {end['kilobytes at the end']:,.0f} kB.")
    return "\n".join(lines)


def image(name, words):
    return f"![{words}](pictures/experiments-{name}.svg)"


def generated(t):
    narrow = lambda name: time(t.value("scaling", name, 4000, "narrow_median"))  # noqa: E731
    rows = statements_broad(t) + statements_trees(t) + statements_scale(t)
    parts = [BEGIN, ""] + [f"* {remark}" for remark in t.remarks] + [
        "", "### Statement by statement", "", table(["the paper says", "its figures", "here", ""], rows).replace("--:", "---"),
        "", "### Figures 4 and 5: broad phases", "", image("broad", "broad phases"),
        "", rates_table(t, "figure-4", (FIRST, 300, HALF)), "", rates_table(t, "figure-5", (FIRST, HALF, FULL)),
        "", "### Figures 6 and 8: where the time goes", "", image("update", "parts of a frame"), "", split_table(t),
        "", "### Figure 7: trees", "", image("trees", "sphere trees in the narrow phase"),
        "", rates_table(t, "figure-7", (FIRST, HALF, FULL), narrow),
        "", "### Figure 9, scaling, Table 1", ""]
    if t.rendered:
        parts += [image("rendered", "with rendering"), "", rendered_table(t), ""]
    parts += [rates_table(t, "scaling", t.counts("scaling")),
              "", "### A thousand objects", "", thousand_table(t),
              "", "### Our own broad phase, and 100,000 objects", "", image("own", "our own broad phase"),
              "", rates_table(t, "broad-phases", t.counts("broad-phases")), "", scaling_table(t),
              "", capacity_table(t), "", "### What must never happen", "", proofs(t)]
    return "\n".join(parts + ["", END])


def with_block(page, block):
    begin, end = page.index(BEGIN), page.index(END)
    return page[:begin] + block + page[end + len(END):]


def collect(reports, results):
    """experiments-rendered.csv from the JSON reports of a folder."""
    rows = []
    for path in reports.glob("*.json"):
        report = json.loads(path.read_text(encoding="utf-8"))
        settings, spent = report["settings"], report["microseconds"]
        rows.append([settings["objects"], settings["levels"], report["frames"], spent["collision"]["median"],
                     spent["step_processor_time"]["median"], spent["render"]["median"],
                     spent["render_processor_time"]["median"]])
    with open(results / RENDERED, "w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(RENDERED_COLUMNS)
        writer.writerows(sorted(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--results", type=Path, default=ROOT / "tests/bench/results")
    parser.add_argument("--page", type=Path, default=ROOT / "docs/experiments.md")
    parser.add_argument("--pictures", type=Path, default=ROOT / "docs/pictures")
    parser.add_argument("--check", action="store_true", help="write nothing, say what differs")
    parser.add_argument("--collect", type=Path, metavar="FOLDER", help="make a table of rendered runs, nothing else")
    options = parser.parse_args()
    if options.collect:
        collect(options.collect, options.results)
        return 0

    tables = Tables(options.results)
    page = options.page.read_text(encoding="utf-8")
    outputs = {options.page: with_block(page, generated(tables))}
    pictures = {"broad": picture_broad, "update": picture_update, "trees": picture_trees, "own": picture_own}
    if tables.rendered:
        pictures["rendered"] = picture_rendered
    for name, draw in pictures.items():
        outputs[options.pictures / f"experiments-{name}.svg"] = draw(tables)
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
    except (OSError, KeyError) as failure:
        sys.exit(f"plot_experiments.py: {failure}")
