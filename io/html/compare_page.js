// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a comparison: builders against each other on one mesh, as in the JSON.
"use strict";

(() => {
  const {element, short, count, percent, seconds, describe, tile} = Page;
  const comparison = Page.dataOf("comparison-data");
  const at = (id) => document.getElementById(id);
  const done = comparison.rows.filter((row) => row.state === "done").map((row, index) => ({
    ...row, index, last: row.levels[row.levels.length - 1]}));
  const failed = comparison.rows.filter((row) => row.state !== "done");
  const mesh = comparison.mesh;

  // Qualities of one builder share its colour and mark, and differ in dashes.
  const builders = [...new Set(done.map((row) => row.builder))];
  const look = (row) => {
    const family = done.filter((other) => other.builder === row.builder);
    const place = family.indexOf(row);
    const builder = builders.indexOf(row.builder);
    return {hue: builder, mark: Page.mark(builder), dash: [[], [7, 4], [2, 3], [9, 3, 2, 3]][place % 4]};
  };

  function head() {
    const title = "Builders compared on " + Page.fileName(mesh.path);
    document.title = title;
    at("title").textContent = title;
    at("lead").textContent = count(done.length) + " trees of " + count(mesh.triangles) + " triangles" +
      (comparison.poses ? ", runtime measured on " + count(comparison.poses.count) + " close poses" : "");
    const least = (key) => done.reduce((best, row) => (best === null || key(row) < key(best) ? row : best), null);
    const show = (row, value, label) => {
      if (row) at("tiles").append(tile(value(row), label + ": " + row.name));
    };
    show(least((row) => row.last.overhang_worst_relative), (row) => percent(row.last.overhang_worst_relative), "least overhang");
    show(least((row) => row.build_seconds), (row) => seconds(row.build_seconds), "fastest build");
    show(least((row) => row.last.microseconds_per_close_pair), (row) => short(row.last.microseconds_per_close_pair) + " µs",
         "cheapest query, last level");
    at("tiles").append(tile(count(done.filter((row) => row.non_dominated).length), "trees that none beats"));
  }

  const star = (one) => (one.non_dominated ? element("span", {class: "star", title: "no other row beats it"}, "★ ") : "");
  const named = (text, one) => element("span", {}, star(one), text);
  const numbers = (last) => [
    {title: "spheres", sort: (row) => last(row).spheres, cell: (row) => count(last(row).spheres)},
    {title: "worst overhang", sort: (row) => last(row).overhang_worst_relative, cell: (row) => percent(last(row).overhang_worst_relative)},
    {title: "mean", sort: (row) => last(row).overhang_mean_relative, cell: (row) => percent(last(row).overhang_mean_relative)},
    {title: "volume ratio", sort: (row) => last(row).volume_ratio, cell: (row) => short(last(row).volume_ratio, 4)},
    {title: "µs per close pair", sort: (row) => last(row).microseconds_per_close_pair,
     cell: (row) => short(last(row).microseconds_per_close_pair)},
    {title: "sphere tests", sort: (row) => last(row).sphere_tests_per_close_pair,
     cell: (row) => short(last(row).sphere_tests_per_close_pair)},
  ];
  const mark = (line, one) => line.classList.toggle("best", one.non_dominated === true);

  function tables() {
    Page.fillTable(at("rows"), [
      {title: "builder", kind: "text", sort: (row) => row.index, cell: (row) => named(row.name, row)},
      {title: "build seconds", sort: (row) => row.build_seconds, cell: (row) => short(row.build_seconds)},
      {title: "levels", sort: (row) => row.levels.length, cell: (row) => count(row.levels.length)},
      ...numbers((row) => row.last),
    ], done, mark);
    for (const row of failed) {
      at("rows").after(element("p", {class: "bad"}, row.name + ": " + (row.reason || row.state)));
    }
    const levels = done.flatMap((row) => row.levels.map((level) => ({...level, row})));
    Page.fillTable(at("levels"), [
      {title: "builder", kind: "text", sort: (level) => level.row.index, cell: (level) => named(level.row.name, level)},
      {title: "level", sort: (level) => level.level, cell: (level) => count(level.level)},
      ...numbers((level) => level),
      {title: "covered", kind: "text", cell: (level) => (level.solid_certified ? "solid" : level.surface_certified ? "surface" : "not proved")},
    ], levels, mark);
  }

  function plots() {
    const lines = (x) => done.map((row) => ({
      label: row.name, ...look(row),
      points: row.levels.filter((level) => x(level) > 0 && level.overhang_worst_relative > 0).map((level) => ({
        x: x(level), y: level.overhang_worst_relative,
        note: "level " + level.level + (level.non_dominated ? ", unbeaten" : "")})),
    })).filter((series) => series.points.length > 0);
    const y = "worst overhang, of the diagonal";
    Page.scatter(at("speed-chart"), {x: "µs per close pair", y, yText: percent, series: lines((level) => level.microseconds_per_close_pair)});
    // The root is the same ball for all.
    Page.scatter(at("spheres-chart"), {x: "spheres", y, xText: count, yText: percent,
                                       series: lines((level) => (level.level > 0 ? level.spheres : 0))});
    const points = done.filter((row) => row.build_seconds > 0 && row.last.overhang_worst_relative > 0);
    Page.scatter(at("build-chart"), {x: "seconds of building", y, yText: percent, series: points.map((row) => ({
      label: row.name, ...look(row), radius: 7, line: false,
      points: [{x: row.build_seconds, y: row.last.overhang_worst_relative, note: count(row.last.spheres) + " spheres"}]}))});
  }

  function facts() {
    const plain = (value) => (Page.isNumber(value) ? short(value, 6) : String(value));
    describe(at("settings"), Object.entries(comparison.settings || {}).map(([key, value]) => [key.replace(/_/g, " "), plain(value)]));
    describe(at("settings"), [["threads of the builds", comparison.threads && count(comparison.threads)]]);
    describe(at("mesh"), [
      ["file", element("code", {}, mesh.path)], ["triangles", count(mesh.triangles)], ["components", count(mesh.components)],
      ["diagonal", short(mesh.diagonal, 6)],
      ["repair", mesh.repair && (mesh.repair.actions.length ? mesh.repair.rule + ": " + mesh.repair.actions.join(" ") : "none was needed")],
      ["content hash", element("span", {class: "hash"}, mesh.content_hash)],
    ]);
    const tool = comparison.tool;
    at("colophon").textContent = tool.name + " " + tool.version + ", revision " + tool.git_revision +
      ". Times are of the machine that made this page.";
  }

  head();
  tables();
  plots();
  facts();
  Page.followColours();
  Page.ready();
})();
