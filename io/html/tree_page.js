// SPDX-License-Identifier: GPL-3.0-or-later
// The page of one tree: what the JSON report says, and the controls of the picture.
"use strict";

(() => {
  const {element, short, count, percent, seconds, bytes, describe, tile} = Page;
  const report = Page.dataOf("report-data");
  const data = Page.dataOf("view-data");
  const at = (id) => document.getElementById(id);
  const levels = report.levels;
  const last = levels[levels.length - 1];
  const settings = report.settings || {};
  const treeName = report.tree.path ? Page.fileName(report.tree.path) : Page.fileName(report.mesh.path);

  // --- text ---

  function summary() {
    const title = "Sphere tree of " + Page.fileName(report.mesh.path);
    document.title = title;
    at("title").textContent = title;
    const chains = report.certificate;
    const solid = chains.solid_chains && chains.solid_chains.certified;
    const certified = chains.surface_chains.certified;
    at("lead").append(
      (report.tree.path ? treeName + ": " : "") + count(levels.length) + (levels.length === 1 ? " level, " : " levels, ") +
        count(report.tree.spheres) + " spheres, ",
      certified ? element("span", {class: "good"}, "certified: every level covers the whole " + (solid ? "solid" : "surface"))
                : element("span", {class: "bad"}, "not certified"),
      report.error_bound_met === false ? element("span", {class: "bad"}, "; the last level misses the error asked for") : "");
    const total = (report.stages || []).reduce((sum, stage) => sum + stage.seconds, 0);
    at("tiles").append(
      tile(count(last.spheres), "spheres on the last level"),
      tile(percent(last.overhang_worst_relative.upper), "worst overhang, of the diagonal"),
      tile(percent(last.overhang_mean_relative), "mean overhang"),
      tile(short(last.volume_ratio, 4), "volume of the balls / of the solid"),
      tile(count(report.mesh.triangles), "triangles"));
    if (total > 0) at("tiles").append(tile(seconds(total), "on " + report.threads + (report.threads === 1 ? " thread" : " threads") + ", proofs included"));
  }

  const winnersText = (level) =>
    Object.entries(level.winners || {}).map(([name, sets]) => name + " " + count(sets)).join(", ");
  const coverText = (cover) =>
    cover.certified ? element("span", {class: "good"}, "yes") : "not " + percent(cover.uncovered.upper);

  function levelTable(choose) {
    const columns = [
      {title: "level", cell: (level) => element("a", {href: "#view-title"}, count(level.level))},
      {title: "spheres", cell: (level) => count(level.spheres)},
      {title: "worst", cell: (level) => percent(level.overhang_worst_relative.upper)},
      {title: "mean", cell: (level) => percent(level.overhang_mean_relative)},
      {title: "worst, mesh units", cell: (level) => short(level.overhang_worst.upper, 4)},
      {title: "volume ratio", cell: (level) => short(level.volume_ratio, 4)},
      {title: "surface covered", cell: (level) => coverText(level.surface_cover)},
      {title: "solid covered", cell: (level) => coverText(level.solid_cover)},
    ];
    if (levels.some(speed.of)) columns.push({title: speed.title, cell: (level) => short(speed.of(level))});
    if (levels.some(winnersText)) columns.push({title: "sets won", kind: "wide", cell: winnersText});
    return Page.fillTable(at("levels"), columns, levels, (line, level) => {
      line.classList.add("pick");
      line.addEventListener("click", () => choose(level.level));
    });
  }

  // Pages that are to be the same every time know no clock, but how many spheres were tested.
  const speed = levels.some((level) => level.microseconds_per_close_pair > 0)
    ? {of: (level) => level.microseconds_per_close_pair, title: "µs per close pair", note: "measured where the report was made"}
    : {of: (level) => level.sphere_tests_per_close_pair, title: "sphere tests per close pair",
       note: "counted in tests of two spheres, which are the same on every machine"};

  function plots() {
    const drawn = levels.filter((level) => level.overhang_worst_relative.upper > 0);
    const series = (x) => [
      {label: "worst", points: drawn.filter((level) => x(level) > 0).map((level) => ({
        x: x(level), y: level.overhang_worst_relative.upper, note: "level " + level.level}))},
      {label: "mean", points: drawn.filter((level) => x(level) > 0 && level.overhang_mean_relative > 0).map((level) => ({
        x: x(level), y: level.overhang_mean_relative, note: "level " + level.level}))},
    ];
    Page.scatter(at("spheres-chart"), {x: "spheres", y: "overhang, of the diagonal", yText: percent, xText: count,
                                       series: series((level) => level.spheres)});
    if (!levels.some(speed.of)) {
      at("speed-card").remove();
      return;
    }
    Page.scatter(at("speed-chart"), {x: speed.title, y: "overhang, of the diagonal", yText: percent, series: series(speed.of)});
    at("speed-note").textContent =
      "What a query of two copies of this tree costs when it may go down to a level: the mean over " +
      "poses in which the objects are close, " + speed.note + ".";
  }

  function facts() {
    const mesh = report.mesh;
    const words = (key) => key.replace(/_/g, " ");
    const plain = (value) => (Array.isArray(value) ? value.join(", ") : Page.isNumber(value) ? short(value, 6) : String(value));
    describe(at("settings"), Object.entries(settings).map(([key, value]) => [words(key), plain(value)]));
    describe(at("settings"), [["threads", report.threads && count(report.threads)], ["frame", report.frame]]);
    if (report.max_error) describe(at("settings"), [["max error", percent(report.max_error)]]);
    const size = [0, 1, 2].map((k) => short(mesh.bounds.max[k] - mesh.bounds.min[k], 4)).join(" × ");
    describe(at("mesh"), [
      ["file", element("code", {}, mesh.path)],
      ["triangles, vertices", count(mesh.triangles) + ", " + count(mesh.vertices)],
      ["components", count(mesh.components)],
      ["genus", mesh.genus === null ? null : count(mesh.genus)],
      ["bounding box", size + " " + mesh.units],
      ["diagonal", short(mesh.diagonal, 6)],
      ["area, volume", short(mesh.area, 4) + ", " + short(mesh.volume, 4)],
      ["repair", mesh.repair.actions.length ? mesh.repair.rule + ": " + mesh.repair.actions.join(" ") : "none was needed"],
      ["content hash", element("span", {class: "hash"}, mesh.content_hash)],
    ]);
    const chain = (name, proof) => proof && proof.certified
      ? element("p", {}, element("span", {class: "good"}, "Proved: "), "every point of the " + name +
          " lies in a chain of spheres from the root to the last level. " + count(proof.cells) +
          " pieces were looked at, the deepest subdivision was " + count(proof.deepest_subdivision) + ".")
      : element("p", {class: name === "surface" ? "bad" : "note"}, "Chains for the " + name + ": " +
          (proof && name === "surface" ? "not proved." : "not asked for."));
    at("proof").append(chain("surface", report.certificate.surface_chains), chain("solid", report.certificate.solid_chains),
                       element("p", {class: "note"}, "tree ", element("span", {class: "hash"}, report.tree.content_hash)));
    if (!report.stages) {
      at("stages-card").remove();
    } else {
      describe(at("stages"), report.stages.map((stage) => [stage.stage, seconds(stage.seconds)]));
      describe(at("stages"), [["peak memory", bytes(report.peak_memory_bytes)]]);
    }
    const tool = report.tool;
    at("colophon").textContent = tool.name + " " + tool.version + ", revision " + tool.git_revision +
      ". Lengths are in the units of the mesh file unless they are a share of the diagonal of its bounding box.";
    if (data.mesh.shown < report.mesh.triangles) {
      at("mesh-note").textContent = "The mesh is drawn with " + count(data.mesh.shown) + " of its " +
        count(report.mesh.triangles) + " triangles; the figures are of all of them.";
    }
  }

  // --- picture ---

  /** What the balls are coloured by, and the legend that says so. */
  const colourings = {
    overhang(level, view) {
      const worst = Math.max(level.overhang[level.worst], Number.MIN_VALUE);
      const bar = element("div", {class: "scale", role: "img", "aria-label": "colour scale from 0 to the worst of the level"});
      bar.style.background = scaleGradient();
      at("legend").replaceChildren(bar, element("div", {class: "ticks"}, element("span", {}, "0"),
        element("span", {}, percent(worst / view.size / 2)), element("span", {}, percent(worst / view.size))));
      return (place) => scaleColour(level.overhang[place] / worst);
    },
    maker(level) {
      const names = data.makers;
      const sets = names.map(() => new Set());
      const balls = names.map(() => 0);
      for (let k = 0; k < level.count; ++k) {
        const maker = level.makers ? level.makers[k] : 0;
        sets[maker].add(level.parents[k]);
        ++balls[maker];
      }
      const items = names.map((name, k) => balls[k] === 0 ? null : element("li", {}, swatch(Page.hue(k)),
        k === 0 ? "nobody: " + count(balls[k]) + (balls[k] === 1 ? " ball stands" : " balls stand") + " for itself"
                : name + ": " + count(sets[k].size) + (sets[k].size === 1 ? " set, " : " sets, ") + count(balls[k]) + " balls"));
      at("legend").replaceChildren(element("ul", {class: "key"}, ...items));
      return (place) => rgb(Page.hue(level.makers ? level.makers[place] : 0));
    },
    family(level) {
      at("legend").replaceChildren();
      return (place) => {
        const colour = new THREE.Color().setHSL((0.11 + 0.6180339887 * level.parents[place]) % 1, 0.55, 0.56);
        return [colour.r, colour.g, colour.b];
      };
    },
  };

  function swatch(colour) {
    const box = element("span", {class: "swatch"});
    box.style.background = colour;
    return box;
  }

  function rgb(hex) {
    const number = parseInt(hex.slice(1), 16);
    return [(number >> 16 & 255) / 255, (number >> 8 & 255) / 255, (number & 255) / 255];
  }

  function describeBall(view) {
    const level = view.levels[view.level];
    const place = view.selected;
    const box = at("ball");
    if (place < 0) {
      box.replaceChildren("Click a ball, or step through them with ‹ and ›.");
      return;
    }
    const centre = [0, 1, 2].map((k) => short(level.raw[4 * place + k], 4)).join(", ");
    const maker = level.makers && level.makers[place] ? data.makers[level.makers[place]] : null;
    const list = element("dl");
    describe(list, [["centre", centre], ["radius", short(level.raw[4 * place + 3], 4)],
                    ["overhang", percent(level.overhang[place] / view.size) + (place === level.worst ? " (worst)" : "")],
                    ["set won by", maker]]);
    box.replaceChildren(element("h3", {}, "Ball " + count(place) + " of " + count(level.count)), list);
  }

  function withView(view, rows) {
    let chosen = "overhang";
    const recolour = () => view.setTints(colourings[chosen](view.levels[view.level], view));
    const pick = (place) => {
      view.select(place);
      describeBall(view);
    };
    const step = (by) => {
      const total = view.levels[view.level].count;
      const place = view.selected < 0 ? (by > 0 ? 0 : total - 1) : (view.selected + by + total) % total;
      view.face(place);
      describeBall(view);
    };
    const choose = (level) => {
      view.setLevel(level);
      recolour();
      at("level").value = level;
      at("level").setAttribute("aria-valuetext", "level " + level + ", " + count(levels[level].spheres) + " spheres");
      at("level-out").textContent = level + ": " + count(levels[level].spheres) + (levels[level].spheres === 1 ? " ball" : " balls");
      rows.forEach((entry) => entry.line.classList.toggle("current", entry.row.level === level));
      describeBall(view);
    };
    const opacity = (id, set) => {
      const show = () => {
        at(id + "-out").textContent = at(id).value + " %";
        set(at(id).value / 100);
      };
      at(id).addEventListener("input", show);
      show();
    };
    view.onPick = pick;
    view.onDrawn = () => flag(view);
    at("level").max = levels.length - 1;
    at("level-ticks").append(...levels.map((level) => element("span", {}, String(level.level))));
    at("level").addEventListener("input", () => choose(Number(at("level").value)));
    at("colour").addEventListener("change", () => {
      chosen = at("colour").value;
      recolour();
    });
    at("worst").addEventListener("click", () => {
      view.face(view.levels[view.level].worst);
      describeBall(view);
    });
    at("previous").addEventListener("click", () => step(-1));
    at("next").addEventListener("click", () => step(1));
    at("reset").addEventListener("click", () => {
      view.reset();
      pick(-1);
    });
    at("picture").addEventListener("keydown", (event) => {
      const level = Number.parseInt(event.key, 10);
      if (event.key.length === 1 && level >= 0 && level < levels.length) choose(level);
    });
    if (!data.makers || data.makers.length < 2) at("colour").querySelector("[value=maker]").remove();
    opacity("ball-opacity", (value) => view.setBallOpacity(value));
    opacity("mesh-opacity", (value) => view.setMeshOpacity(value));
    // The root hides what there is to see, and many balls are too small for a first look.
    const first = levels.findIndex((level) => level.spheres >= 30);
    choose(first < 0 ? levels.length - 1 : first);
    Page.onColours(() => {
      view.setMarks(Page.colour("bad"), Page.colour("accent"));
      recolour();
    });
    view.resize();
    return choose;
  }

  function flag(view) {
    const level = view.levels[view.level];
    const top = view.topOf(level.worst);
    const box = at("flag");
    box.hidden = !top.visible || !view.balls.visible;
    box.textContent = "worst " + percent(level.overhang[level.worst] / view.size);
    box.style.transform = "translate(" + Math.round(top.x - 12) + "px," + Math.round(Math.max(top.y - 46, 4)) + "px)";
  }

  summary();
  let choose = () => {};
  const rows = levelTable((level) => choose(level));
  facts();
  let view = null;
  try {
    view = new TreeView(at("picture"), data, () => {});
  } catch (problem) {
    at("picture").replaceChildren(element("p", {class: "hint"}, "No 3D picture: this browser offers no WebGL."));
    at("controls").hidden = true;
  }
  if (view) choose = withView(view, rows);
  plots();  // while the picture is drawn
  Page.followColours();
  if (view) view.whenSeen(Page.ready);
  else Page.ready();
})();
