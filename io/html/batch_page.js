// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a batch: one row per asset, as in the JSON summary.
"use strict";

(() => {
  const {element, short, count, percent, seconds, bytes, describe, tile} = Page;
  const summary = Page.dataOf("summary-data");
  const thumbnails = Page.dataOf("thumbnail-data");
  const at = (id) => document.getElementById(id);
  const run = summary.run || {};
  const runOf = new Map((run.assets || []).map((asset) => [asset.output, asset]));
  const rows = (summary.assets || []).map((asset, index) => ({
    asset,
    run: runOf.get(asset.output) || {},
    thumbnail: thumbnails[index] || "",
    last: asset.levels && asset.levels.length ? asset.levels[asset.levels.length - 1] : null,
  }));
  const kStates = {done: "good", missed: "bad", failed: "bad", pending: "note"};

  function head() {
    const totals = summary.totals;
    const bad = (totals.failed || 0) + (totals.missed || 0) + (totals.pending || 0);
    const shard = summary.shard ? ", shard " + summary.shard.index + " of " + summary.shard.count : "";
    at("lead").append(count(totals.assets) + " assets" + shard + ": ",
      bad === 0 ? element("span", {class: "good"}, "all of them have a certified tree")
                : element("span", {class: "bad"}, count(totals.done) + " done, " + count(bad) + " not"));
    at("tiles").append(tile(count(totals.done), "done"));
    for (const state of ["missed", "failed", "pending"]) {
      if (totals[state]) at("tiles").append(tile(count(totals[state]), state === "missed" ? "missed the error asked for" : state));
    }
    at("tiles").append(tile(count(totals.triangles), "triangles in"), tile(count(totals.spheres), "spheres out"),
                       tile(bytes(totals.bytes), "of trees"));
    if (run.seconds) at("tiles").append(tile(seconds(run.seconds), "this run, " + run.jobs + (run.jobs === 1 ? " job" : " jobs")));
    if (run.peak_memory_bytes) at("tiles").append(tile(bytes(run.peak_memory_bytes), "peak memory of an asset"));
  }

  // Paths of files as addresses: every part encoded, the slashes between them kept.
  const address = (path) => path.split("/").map(encodeURIComponent).join("/");

  function picture(row) {
    if (!row.thumbnail) return "";
    const holder = new DOMParser().parseFromString(row.thumbnail, "image/svg+xml").documentElement;
    const svg = document.importNode(holder, true);
    if (!row.asset.page) return svg;
    return element("a", {href: address(row.asset.page), "aria-hidden": "true", tabindex: "-1"}, svg);
  }

  /** With the reason below it when there is one. */
  function name(row) {
    const {input, page, reason} = row.asset;
    const title = page ? element("a", {href: address(page)}, input) : input;
    // The sentence begins with the name of the file, which stands above it.
    const why = reason && reason.startsWith(input + ": ") ? reason.slice(input.length + 2) : reason;
    return element("div", {}, title, why ? element("div", {class: "note"}, why) : "");
  }

  function table() {
    const columns = [
      {title: "asset", kind: "asset", sort: (row) => row.asset.input, cell: name},
      {title: "state", kind: "text", sort: (row) => row.asset.state, cell: (row) =>
        element("span", {class: "state " + (kStates[row.asset.state] || "")}, row.asset.state)},
      {title: "triangles", sort: (row) => row.asset.mesh && row.asset.mesh.triangles,
       cell: (row) => count(row.asset.mesh && row.asset.mesh.triangles)},
      {title: "levels", sort: (row) => row.asset.tree && row.asset.tree.levels,
       cell: (row) => count(row.asset.tree && row.asset.tree.levels)},
      {title: "spheres", sort: (row) => row.asset.tree && row.asset.tree.spheres,
       cell: (row) => count(row.asset.tree && row.asset.tree.spheres)},
      {title: "worst overhang", sort: (row) => row.last && row.last.overhang_worst_relative,
       cell: (row) => percent(row.last && row.last.overhang_worst_relative)},
      {title: "mean", sort: (row) => row.last && row.last.overhang_mean_relative,
       cell: (row) => percent(row.last && row.last.overhang_mean_relative)},
      {title: "volume ratio", sort: (row) => row.last && row.last.volume_ratio, cell: (row) => short(row.last && row.last.volume_ratio, 4)},
      {title: "seconds", sort: (row) => row.run.seconds, cell: (row) => short(row.run.seconds)},
      {title: "memory", sort: (row) => row.run.peak_memory_bytes, cell: (row) => bytes(row.run.peak_memory_bytes)},
    ];
    if (rows.some((row) => row.thumbnail)) columns.splice(1, 0, {title: "", kind: "text", cell: picture});
    return Page.fillTable(at("assets"), columns, rows);
  }

  function filters(lines) {
    const states = [...new Set(rows.map((row) => row.asset.state))].sort();
    at("state").append(...states.map((state) => element("option", {value: state}, state)));
    const apply = () => {
      const words = at("filter").value.toLowerCase();
      let shown = 0;
      for (const {line, row} of lines) {
        const text = (row.asset.input + " " + (row.asset.reason || "")).toLowerCase();
        line.hidden = !text.includes(words) || (at("state").value !== "" && row.asset.state !== at("state").value);
        shown += line.hidden ? 0 : 1;
      }
      at("shown").textContent = shown === lines.length ? "" : count(shown) + " of " + count(lines.length);
    };
    at("filter").addEventListener("input", apply);
    at("state").addEventListener("change", apply);
  }

  function scene() {
    const budget = summary.scene;
    if (!budget) return;
    at("scene-card").hidden = false;
    const totals = budget.totals;
    const saved = (now, full) => (full > 0 ? percent(1 - now / full) + " less" : "");
    at("scene-lead").textContent = count(totals.instances) + " instances: trees of " + bytes(totals.file_bytes) + " instead of " +
      bytes(totals.full_file_bytes) + " at full depth (" + saved(totals.file_bytes, totals.full_file_bytes) + "), " +
      short(totals.sphere_tests) + " sphere tests per close pair instead of " + short(totals.full_sphere_tests) + " (" +
      saved(totals.sphere_tests, totals.full_sphere_tests) + ").";
    const number = (title, key, text) => ({title, sort: (row) => row[key], cell: (row) => text(row[key])});
    Page.fillTable(at("scene"), [
      {title: "tree", kind: "text", sort: (row) => row.output, cell: (row) => row.output},
      number("instances", "instances", count), number("largest scale", "largest_scale", short), number("tolerance", "tolerance", short),
      number("levels", "levels", count), number("of", "full_levels", count), number("spheres", "spheres", count),
      number("of", "full_spheres", count), number("in memory", "runtime_bytes", bytes), number("of", "full_runtime_bytes", bytes),
      number("sphere tests", "sphere_tests", short), number("of", "full_sphere_tests", short),
    ], budget.assets);
  }

  function chart() {
    const drawn = rows.filter((row) => row.last && row.last.overhang_worst_relative > 0);
    if (drawn.length === 0) {
      at("chart-card").remove();
      return;
    }
    const series = ["done", "missed"].map((state, k) => ({
      label: state, line: false, hue: k, radius: 4,
      points: drawn.filter((row) => row.asset.state === state).map((row) => ({
        x: row.last.spheres, y: row.last.overhang_worst_relative, note: row.asset.input})),
    })).filter((one) => one.points.length > 0);
    Page.scatter(at("chart"), {x: "spheres on the last level", y: "worst overhang, of the diagonal", xText: count, yText: percent,
                               series, legend: series.length > 1});
  }

  function facts() {
    const plain = (value) => (Array.isArray(value) ? value.join(", ") : Page.isNumber(value) ? short(value, 6) : String(value));
    describe(at("run"), Object.entries(summary.settings || {}).map(([key, value]) => [key.replace(/_/g, " "), plain(value)]));
    const actions = [...runOf.values()].reduce((sum, asset) => sum.set(asset.action, (sum.get(asset.action) || 0) + 1), new Map());
    describe(at("run"), [
      ["this run", [...actions].map(([action, number]) => count(number) + " " + (action === "none" ? "left alone" : action)).join(", ")],
      ["jobs, threads", run.jobs ? run.jobs + ", " + run.threads : null],
      ["memory limit", run.memory_limit_bytes ? bytes(run.memory_limit_bytes) : null],
    ]);
    const tool = summary.tool;
    if (tool) at("colophon").textContent = tool.name + " " + tool.version + ", revision " + tool.git_revision + ".";
  }

  head();
  filters(table());
  scene();
  chart();
  facts();
  Page.followColours();
  Page.ready();
})();
