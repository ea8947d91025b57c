// SPDX-License-Identifier: GPL-3.0-or-later
// What all pages share: elements, numbers, tables that sort, charts that follow the colours of the page.
"use strict";

const Page = (() => {
  const dataOf = (id) => JSON.parse(document.getElementById(id).textContent);

  /** An element with attributes and children; text stays text. */
  function element(name, attributes = {}, ...children) {
    const result = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
      if (value !== null && value !== undefined && value !== false) result.setAttribute(key, value);
    }
    result.append(...children.filter((child) => child !== null && child !== undefined));
    return result;
  }

  const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

  /** A number with so many digits that matter; never a surprise exponent for everyday sizes. */
  function short(value, digits = 3) {
    if (!isNumber(value)) return "–";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e7 || size < 1e-5) return value.toExponential(digits - 1);
    const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
    return value.toLocaleString("en", {maximumFractionDigits: decimals, useGrouping: size >= 1e4});
  }
  const count = (value) => (isNumber(value) ? value.toLocaleString("en") : "–");
  const percent = (fraction) => (isNumber(fraction) ? short(100 * fraction) + " %" : "–");
  const seconds = (value) => (isNumber(value) ? short(value) + " s" : "–");
  function bytes(value) {
    if (!isNumber(value)) return "–";
    const units = ["bytes", "kB", "MB", "GB"];
    let unit = 0;
    while (value >= 1000 && unit + 1 < units.length) {
      value /= 1000;
      ++unit;
    }
    return short(value) + " " + units[unit];
  }
  const fileName = (path) => String(path).replace(/^.*\//, "");

  /** Appends `dt`, `dd` pairs; those without a value are left out. */
  function describe(list, pairs) {
    for (const [term, value] of pairs) {
      if (value === null || value === undefined || value === "") continue;
      list.append(element("dt", {}, term), element("dd", {}, value));
    }
  }

  function tile(value, label) {
    return element("li", {}, element("b", {}, value), element("span", {}, label));
  }

  /**
   * Fills a table. A column is {title, cell(row) -> text or node, sort(row) -> key, kind: "text"|"wide"|undefined};
   * columns with `sort` get a button in their head.
   */
  function fillTable(table, columns, rows, decorate = () => {}) {
    const body = element("tbody");
    const lines = rows.map((row, index) => {
      const line = element("tr");
      columns.forEach((column, place) => {
        const cell = element(place === 0 ? "th" : "td", {class: column.kind, scope: place === 0 ? "row" : null});
        cell.append(column.cell(row, index));
        line.append(cell);
      });
      decorate(line, row, index);
      return {line, row, index};
    });
    const show = () => body.replaceChildren(...lines.map((entry) => entry.line));
    const heads = columns.map((column) => {
      const head = element("th", {scope: "col", class: column.kind === "wide" ? "text" : column.kind});
      if (!column.sort) {
        head.append(column.title);
        return head;
      }
      const button = element("button", {type: "button"}, column.title);
      button.addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending";
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        lines.sort((a, b) => compareKeys(column.sort(a.row), column.sort(b.row), down) || a.index - b.index);
        show();
      });
      head.append(button);
      return head;
    });
    show();
    table.append(element("thead", {}, element("tr", {}, ...heads)), body);
    return lines;
  }

  /** Missing values come last either way. */
  function compareKeys(a, b, down) {
    const missing = (key) => key === null || key === undefined || Number.isNaN(key);
    if (missing(a) || missing(b)) return missing(a) - missing(b);
    const order = typeof a === "string" ? a.localeCompare(b, "en", {numeric: true}) : a - b;
    return down ? -order : order;
  }

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

  // Told apart with any kind of colour vision (Okabe, Ito 2008), readable on white and on black.
  const kHues = ["#0072b2", "#d55e00", "#009e73", "#b85c91", "#9a7000", "#3b93c4", "#8a63d2", "#6b6b6b"];
  const kHuesInTheDark = ["#5fb4ee", "#ff9c52", "#3fd6a6", "#eaa3c9", "#e6bd55", "#a5d8f7", "#bda4f5", "#b5b5b5"];
  const isDark = () => window.matchMedia("screen and (prefers-color-scheme: dark)").matches;
  const hue = (index) => (isDark() ? kHuesInTheDark : kHues)[index % kHues.length];
  const kMarks = ["circle", "rect", "triangle", "rectRot", "star", "crossRot", "cross", "rectRounded"];
  const mark = (index) => kMarks[index % kMarks.length];

  // --- charts ---

  const charts = [];

  /** Ticks of a logarithmic axis: 1, 2, 5 of each decade only. */
  function decadeTick(text) {
    return function (value) {
      const digit = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
      return [1, 2, 5].some((d) => Math.abs(digit - d) < 1e-6) ? text(value) : "";
    };
  }

  function axis(title, text) {
    return {
      type: "logarithmic",
      title: {display: true, text: title},
      ticks: {callback: decadeTick(text), maxRotation: 0, autoSkip: false},
    };
  }

  /**
   * A chart of points on two logarithmic axes. `series`: [{label, points: [{x, y, note}], line, dash, mark, radius,
   * hue}], hue being a number of a colour.
   */
  function scatter(canvas, {x, y, series, xText = short, yText = short, legend = true}) {
    const chart = new Chart(canvas, {
      type: "scatter",
      data: {
        datasets: series.map((one, index) => ({
          label: one.label,
          data: one.points,
          showLine: one.line !== false,
          borderDash: one.dash,
          borderWidth: 2,
          hue: one.hue === undefined ? index : one.hue,
          pointStyle: one.mark || mark(index),
          pointRadius: one.radius === undefined ? 5 : one.radius,
          pointHoverRadius: 7,
        })),
      },
      options: {
        animation: false,
        responsive: true,
        maintainAspectRatio: false,
        scales: {x: axis(x, xText), y: axis(y, yText)},
        plugins: {
          legend: {display: legend, position: "bottom", labels: {usePointStyle: true, boxHeight: 7}},
          tooltip: {
            callbacks: {
              label: (item) => item.dataset.label + ": " + (item.raw.note || ""),
              afterLabel: (item) => [x + ": " + xText(item.raw.x), y + ": " + yText(item.raw.y)],
            },
          },
        },
      },
    });
    charts.push(chart);
    paint(chart);
    return chart;
  }

  function paint(chart) {
    chart.options.color = colour("ink");
    for (const series of chart.data.datasets) series.borderColor = series.backgroundColor = hue(series.hue);
    for (const scale of Object.values(chart.options.scales)) {
      scale.grid = {color: colour("line"), borderColor: colour("soft")};
      scale.ticks.color = colour("soft");
      scale.title.color = colour("ink");
    }
    chart.update("none");
  }

  /** Calls back now and whenever the colours of the page change: dark or light, screen or paper. */
  function onColours(callback) {
    callback();
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", callback);
    window.matchMedia("print").addEventListener("change", callback);
  }

  function followColours() {
    onColours(() => charts.forEach(paint));
    window.addEventListener("beforeprint", () => charts.forEach((chart) => chart.resize()));
    window.addEventListener("afterprint", () => charts.forEach((chart) => chart.resize()));
  }

  /** To be called when the page can be used; the time is there for whoever asks. */
  function ready() {
    document.documentElement.dataset.interactiveMs = Math.round(performance.now());
  }

  return {dataOf, element, isNumber, short, count, percent, seconds, bytes, fileName, describe, tile, fillTable,
          colour, hue, mark, scatter, onColours, followColours, ready};
})();
