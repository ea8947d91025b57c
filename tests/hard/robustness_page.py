#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of docs/robustness.md from the table of hard cases and from what was measured.

    robustness_page.py [--page FILE] [--results FOLDER] [--check]

Each block of the page between `<!-- begin: NAME ... -->` and `<!-- end: NAME -->` is replaced. The blocks
`summary`, `cases`, `builders` and `invariance` have their own form; any other NAME shows results/NAME.csv as it
is: lines that begin with # become a list above the table, underscores in heads become blanks. --check writes
nothing and ends with code 1 when the page is not what the files make of it. Standard library only.
"""
import argparse
import csv
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = ROOT / "tests/hard"
MADE_BY = "made by tests/hard/robustness_page.py"
BUILDERS = ["octree", "grid", "hubbard", "spawn", "merge", "burst", "expand", "combined"]
# What the order of vertices and triangles may change, and how far a figure may be from its goal.
CHANGES = [("translation", "worst_in_diagonals", 1e-6), ("scale", "worst_in_diagonals", 1e-6),
           ("rotation", "worst_in_diagonals", 2e-2), ("similarity", "worst_in_diagonals", 2e-2),
           ("vertex order", "worst_relative", 1e-2), ("triangle order", "worst_relative", 1e-2),
           ("duplicate vertices", "worst_relative", 1e-2)]
ERRORS = {"3": "cannot be read", "4": "not suitable"}


def read(path):
    """Rows as dictionaries, and the remarks."""
    lines = path.read_text(encoding="utf-8").splitlines()
    remarks = [line.lstrip("# ") for line in lines if line.startswith("#") and "SPDX" not in line]
    return list(csv.DictReader(line for line in lines if line and not line.startswith("#"))), remarks


def table(head, rows, numbers=()):
    lines = ["| " + " | ".join(head) + " |",
             "| " + " | ".join("--:" if name in numbers else "---" for name in head) + " |"]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


class Corpus:
    """The table of cases, joined with the published runs."""

    def __init__(self, results):
        self.cases, _ = read(HERE / "cases.csv")
        self.runs, self.remarks = read(results / "cases.csv")
        self.by_case = {}
        for run in self.runs:
            self.by_case.setdefault(run["name"], []).append(run)

    def as_expected(self, case, run):
        if run["state"] != case["outcome"]:
            return False
        if run["state"] == "certified":
            return run["rule"] == case["detail"]
        return run["exit_code"] == case["detail"][0]

    def verdict(self, case):
        """Of all runs of a case: as the table says, failed, or not run."""
        runs = self.by_case.get(case["name"], [])
        if not runs:
            return "not run"
        return case["outcome"] if all(self.as_expected(case, run) for run in runs) else "failed"


def summary(corpus):
    verdicts = [corpus.verdict(case) for case in corpus.cases]
    names = {case["name"] for case in corpus.cases}
    runs = [run for run in corpus.runs if run["name"] in names]
    slowest = max(runs, key=lambda run: float(run["cpu_seconds"]))
    largest = max(runs, key=lambda run: float(run["peak_megabytes"]))
    rows = [["hard cases", len(corpus.cases)]]
    rows += [[f"&nbsp;&nbsp;{text}", verdicts.count(kind)] for kind, text in
             (("certified", "certified tree, repair rule as named below"), ("refused", "refused by name"),
              ("failed", "failed"), ("not run", "not run"))]
    rows += [["runs of the program, all builders", len(runs)],
             ["slowest run", f"{slowest['name']} by {slowest['builder']}: {float(slowest['cpu_seconds']):.1f} s"],
             ["largest memory", f"{largest['name']} by {largest['builder']}: {largest['peak_megabytes']} MB"]]
    return [f"* {remark}" for remark in corpus.remarks] + [""] + table(["", "measured"], rows, ["measured"])


def expectation(case):
    if case["outcome"] == "certified":
        return f"certified, `{case['detail']}`"
    return f"refused, exit code {case['detail'][0]}: {ERRORS[case['detail'][0]]}"


def case_row(corpus, case):
    runs = corpus.by_case.get(case["name"], [])
    verdict = corpus.verdict(case)
    seconds = memory = errors = ""
    if runs:
        seconds = f"{max(float(run['cpu_seconds']) for run in runs):.1f}"
        memory = f"{max(float(run['peak_megabytes']) for run in runs):.0f}"
        errors = next((run["level_errors"].replace(" ", ", ") for run in runs if run["builder"] == "combined"), "")
    if errors == "-":
        errors = ""
    end = expectation(case) if verdict in ("certified", "refused") else f"**{verdict}**, wanted: {expectation(case)}"
    return [f"`{case['name']}`", case["what"], end, len(runs), seconds, memory, errors]


def cases(corpus):
    lines = []
    for group in dict.fromkeys(case["group"] for case in corpus.cases):
        lines += ["", f"### {group.replace('_', ' ')}", ""]
        lines += table(["case", "what it is", "ends", "runs", "s", "MB", "worst overhang, %"],
                       [case_row(corpus, case) for case in corpus.cases if case["group"] == group],
                       ["runs", "s", "MB"])
    return lines[1:]


def builders(corpus):
    known = {case["name"]: case for case in corpus.cases}
    rows = []
    for builder in BUILDERS:
        runs = [run for run in corpus.runs if run["builder"] == builder and run["name"] in known]
        if not runs:
            continue
        good = [run for run in runs if corpus.as_expected(known[run["name"]], run)]
        slow = max(runs, key=lambda run: float(run["cpu_seconds"]))
        rows.append([f"`{builder}`", len(runs), sum(run["state"] == "certified" for run in good),
                     sum(run["state"] == "refused" for run in good), len(runs) - len(good),
                     f"{float(slow['cpu_seconds']):.1f} ({slow['name']})",
                     max(int(run["peak_megabytes"]) for run in runs)])
    head = ["builder", "runs", "certified", "refused", "failed", "slowest, s", "most memory, MB"]
    return table(head, rows, head[1:])


def invariance(results):
    rows, remarks = read(results / "invariance.csv")
    lines = [f"* {remark}" for remark in remarks]
    lines.append("* models: " + ", ".join(dict.fromkeys(f"{row['model']} ({row['triangles']})" for row in rows)))
    body = []
    for builder in BUILDERS:
        mine = [row for row in rows if row["builder"] == builder]
        if not mine:
            continue
        cells = []
        for change, column, goal in CHANGES:
            found = [float(row[column]) for row in mine if row["change"] == change]
            worst = max(found) if found else None
            text = "" if worst is None else f"{worst:.1e}" if worst else "0"
            cells.append(f"**{text}**" if worst is not None and worst > goal else text)
        body.append([f"`{builder}`"] + cells)
    head = ["builder"] + [change for change, _, _ in CHANGES]
    goals = ["goal"] + [f"{goal:.0e}" for _, _, goal in CHANGES]
    runs = sorted({row["runs"] for row in rows}, key=int)
    lines.append(f"* runs per model, builder and change: {', '.join(runs)}; what misses its goal is bold")
    widest = max(float(row["bracket"]) for row in rows)
    lines.append(f"* the overhang of a level is bracketed for this to {widest:.1e} of the diagonal or better")
    return lines + [""] + table(head, [goals] + body, head[1:])


def plain(path):
    if not path.exists():
        return ["Not measured yet."]
    rows, remarks = read(path)
    lines = [f"* {remark}" for remark in remarks] + ([""] if remarks else [])
    if not rows:
        return lines
    head = list(rows[0])
    numeric = [name for name in head if all(re.fullmatch(r"[-+0-9.eE %]*", row[name] or "") for row in rows)]
    return lines + table([name.replace("_", " ") for name in head], [[row[name] for name in head] for row in rows],
                         [name.replace("_", " ") for name in numeric])


def filled(page, results):
    corpus = Corpus(results)
    special = {"summary": lambda: summary(corpus), "cases": lambda: cases(corpus),
               "builders": lambda: builders(corpus), "invariance": lambda: invariance(results)}

    def block(match):
        name = match.group(1)
        lines = special[name]() if name in special else plain(results / f"{name}.csv")
        return "\n".join([f"<!-- begin: {name}, {MADE_BY} -->", "", *lines, "", f"<!-- end: {name} -->"])

    return re.sub(r"<!-- begin: (\w+)[^>]*-->.*?<!-- end: \1 -->", block, page, flags=re.DOTALL)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=Path, default=ROOT / "docs/robustness.md")
    parser.add_argument("--results", type=Path, default=HERE / "results")
    parser.add_argument("--check", action="store_true", help="write nothing, say whether the page differs")
    options = parser.parse_args()
    page = options.page.read_text(encoding="utf-8")
    wanted = filled(page, options.results)
    if wanted == page:
        return 0
    if options.check:
        print(f"differs: {options.page}; run tests/hard/robustness_page.py")
        return 1
    options.page.write_text(wanted, encoding="utf-8")
    print(f"wrote {options.page}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, KeyError) as failure:
        sys.exit(f"robustness_page.py: {failure!r}")
