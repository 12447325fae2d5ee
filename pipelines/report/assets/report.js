// Plots of a report: values under the pointer, legend entries that hide and show their curves, and tables of the values
// to save. The drawings are complete without it; what it needs is in their attributes data-* (svg_draw.cpp). Print has all tables unfolded.
"use strict";
(() => {
  const reach = 22; // how far from a curve the pointer may be [px of the view box]

  const numbers = (text) => (text ? text.split(",").map((v) => (v === "" ? NaN : Number(v))) : []);

  /// Number with four digits, powers of ten as superscripts.
  function shown(value) {
    if (value === 0) return "0";
    const size = Math.abs(value);
    const round = Number(value.toPrecision(4));
    if (size >= 1e-3 && size < 1e5) return String(round).replace("-", "\u2212");
    const [digits, power] = value.toExponential(3).split("e");
    const raised = [...String(Number(power))].map((c) => (c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]));
    return Number(digits) + "\u00d710" + raised.join("");
  }

  /// "normal force Fn [N]" -> name and unit.
  function axis(plot, letter) {
    const [scale, low, high] = plot.getAttribute(`data-${letter}-axis`).split(",");
    const label = plot.getAttribute(`data-${letter}-label`);
    const parts = label.match(/^(.*?)\s*\[([^\]]*)\]/);
    const along = scale === "log" ? Math.log : (v) => v;
    const from = along(Number(low));
    const to = along(Number(high));
    return {
      name: parts ? parts[1] : label,
      unit: parts ? parts[2] : "",
      share: (v) => (scale === "log" && !(v > 0) ? NaN : (along(v) - from) / (to - from)),
    };
  }

  function valueText(of, value, error) {
    const unit = of.unit === "" ? "" : (of.unit === "%" ? "\u2009" : " ") + of.unit;
    return shown(value) + (error > 0 ? " \u00b1 " + shown(Number(error.toPrecision(2))) : "") + unit;
  }

  function line(of, value, error) {
    return of.name + ": " + valueText(of, value, error);
  }

  /// One curve with its values and their places [px].
  function readSeries(group, plot) {
    const d = group.dataset;
    const s = { group, entry: d.entry, name: d.name, x: numbers(d.x), y: numbers(d.y), error: numbers(d.error),
      low: numbers(d.low), high: numbers(d.high) };
    s.px = s.x.map((v) => plot.left + plot.width * plot.x.share(v));
    const place = (v) => plot.top + plot.height * (1 - plot.y.share(v));
    s.py = s.y.map(place);
    s.pLow = s.low.map(place);
    s.pHigh = s.high.map(place);
    const drawn = group.querySelector(".line");
    s.joined = drawn !== null;
    if (drawn) group.style.setProperty("--on", drawn.getAttribute("stroke"));
    return s;
  }

  /// Distance of the pointer from a curve, and the point of it that is meant.
  function nearest(s, x, y) {
    let best = { distance: Infinity, index: -1 };
    for (let i = 0; i < s.py.length; ++i) {
      const far = Math.hypot(s.px[i] - x, s.py[i] - y);
      if (far < best.distance) best = { distance: far, index: i };
    }
    if (!s.joined) return best;
    for (let i = 0; i + 1 < s.py.length; ++i) {
      const dx = s.px[i + 1] - s.px[i];
      const dy = s.py[i + 1] - s.py[i];
      const long = dx * dx + dy * dy;
      const share = long > 0 ? Math.min(1, Math.max(0, ((x - s.px[i]) * dx + (y - s.py[i]) * dy) / long)) : 0;
      const far = Math.hypot(s.px[i] + share * dx - x, s.py[i] + share * dy - y);
      if (far < best.distance) best = { distance: far, index: share < 0.5 ? i : i + 1 };
    }
    return best;
  }

  /// The interval at the pointer, when that is inside a band.
  function inBand(s, x, y) {
    for (let i = 0; i + 1 < s.pLow.length; ++i) {
      if (x < s.px[i] || x > s.px[i + 1]) continue;
      const k = x - s.px[i] < s.px[i + 1] - x ? i : i + 1;
      if (y <= s.pLow[k] && y >= s.pHigh[k]) return k;
    }
    return -1;
  }

  /// The values of a plot as CSV: the table of figure_table.cpp, with the digits that the page holds.
  function tableOf(svg) {
    const groups = [...svg.querySelectorAll(".series")].map((g) => g.dataset);
    const unit = (svg.dataset.yLabel.match(/\[[^\]]*\]/) || []).map((u) => " " + u).join("");
    const more = [["error", "error bar"], ["low", "band low"], ["high", "band high"]].filter(([key]) => groups.some((d) => d[key]));
    const rows = [[svg.getAttribute("aria-label"), "curve", svg.dataset.xLabel, svg.dataset.yLabel, ...more.map(([, name]) => name + unit)]];
    for (const d of groups) {
      if (!d.x) continue;
      const columns = [d.x, d.y, ...more.map(([key]) => d[key])].map((values) => (values || "").split(","));
      columns[0].forEach((_, i) => rows.push([d.entry, d.name, ...columns.map((c) => c[i] || "")]));
    }
    const quoted = (cell) => (/[",\n]/.test(cell) ? '"' + cell.replaceAll('"', '""') + '"' : cell);
    return rows.map((row) => row.map(quoted).join(",") + "\n").join("");
  }

  /// Fills the link below a plot when it is used, so that it needs no file beside the page.
  function fillLink(link, svg) {
    if (link.href.startsWith("blob:")) return;
    link.href = URL.createObjectURL(new Blob(["\ufeff" + tableOf(svg)], { type: "text/csv" }));
  }

  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  tip.setAttribute("role", "status");
  document.body.append(tip);

  function showTip(title, lines, event) {
    const head = document.createElement("b");
    head.textContent = title;
    tip.replaceChildren(head);
    for (const text of lines) {
      const row = document.createElement("div");
      row.textContent = text;
      tip.append(row);
    }
    tip.hidden = false;
    const room = document.documentElement.clientWidth;
    const left = Math.min(event.pageX + 14, window.scrollX + room - tip.offsetWidth - 6);
    tip.style.left = Math.max(window.scrollX + 4, left) + "px";
    const below = event.pageY + 18;
    const fits = below + tip.offsetHeight < window.scrollY + document.documentElement.clientHeight;
    tip.style.top = (fits ? below : event.pageY - tip.offsetHeight - 12) + "px";
  }

  class PlotView {
    constructor(svg) {
      this.svg = svg;
      [this.left, this.top, this.width, this.height] = numbers(svg.dataset.frame);
      this.x = axis(svg, "x");
      this.y = axis(svg, "y");
      this.series = [...svg.querySelectorAll(".series")].map((g) => readSeries(g, this));
      // Browsers would show these beside the values; without this script they are what is shown.
      for (const title of svg.querySelectorAll(".series title")) title.remove();
      this.dot = document.createElementNS(svg.namespaceURI, "circle");
      for (const [name, value] of [["r", 4.5], ["fill", "none"], ["stroke", "#1c2126"], ["stroke-width", 1.5]])
        this.dot.setAttribute(name, value);
      this.dot.classList.add("hidden");
      svg.append(this.dot);
      svg.addEventListener("pointermove", (e) => this.look(e));
      svg.addEventListener("pointerdown", (e) => this.look(e));
      svg.addEventListener("pointerleave", () => this.leave());
      for (const entry of svg.querySelectorAll(".entry")) this.makeButton(entry);
      const link = svg.nextElementSibling;
      if (link && link.matches("a.csv")) link.addEventListener("click", () => fillLink(link, svg));
    }

    at(event) {
      const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
      return [p.x, p.y];
    }

    look(event) {
      const [x, y] = this.at(event);
      const inside = x >= this.left - 6 && x <= this.left + this.width + 6 && y >= this.top - 6 && y <= this.top + this.height + 6;
      let best = { distance: inside ? reach : -1 };
      for (const s of this.series) {
        if (s.group.classList.contains("hidden")) continue;
        const one = nearest(s, x, y);
        if (one.distance <= best.distance) best = { ...one, series: s };
      }
      if (best.series && best.distance <= 9) return this.show(best, event);
      for (const s of inside ? this.series : []) {
        const k = s.group.classList.contains("hidden") ? -1 : inBand(s, x, y);
        if (k >= 0) return this.showBand(s, k, event);
      }
      return best.series ? this.show(best, event) : this.leave();
    }

    highlight(series) {
      this.svg.classList.add("hovering");
      for (const s of this.series) s.group.classList.toggle("on", s === series);
    }

    show({ series, index }, event) {
      this.highlight(series);
      this.dot.setAttribute("cx", series.px[index]);
      this.dot.setAttribute("cy", series.py[index]);
      this.dot.classList.remove("hidden");
      showTip(series.name, [line(this.x, series.x[index]), line(this.y, series.y[index], series.error[index])], event);
    }

    showBand(series, k, event) {
      this.highlight(series);
      this.dot.classList.add("hidden");
      const interval = this.y.name + ": " + shown(series.low[k]) + " to " + valueText(this.y, series.high[k]);
      showTip(series.name, [line(this.x, series.x[k]), interval], event);
    }

    leave() {
      this.svg.classList.remove("hovering");
      for (const s of this.series) s.group.classList.remove("on");
      this.dot.classList.add("hidden");
      tip.hidden = true;
    }

    makeButton(entry) {
      entry.setAttribute("role", "button");
      entry.setAttribute("tabindex", "0");
      entry.setAttribute("aria-pressed", "true");
      const box = entry.getBBox();
      const area = document.createElementNS(this.svg.namespaceURI, "rect");
      for (const [name, value] of [["x", box.x], ["y", box.y], ["width", box.width], ["height", box.height], ["fill", "transparent"]])
        area.setAttribute(name, value);
      entry.prepend(area);
      entry.addEventListener("click", () => this.toggle(entry));
      entry.addEventListener("keydown", (e) => {
        if (e.key !== "Enter" && e.key !== " ") return;
        e.preventDefault();
        this.toggle(entry);
      });
    }

    toggle(entry) {
      const off = entry.classList.toggle("off");
      entry.setAttribute("aria-pressed", String(!off));
      for (const s of this.series) if (s.entry === entry.dataset.entry) s.group.classList.toggle("hidden", off);
      this.leave();
    }
  }

  for (const svg of document.querySelectorAll("svg.plot")) new PlotView(svg);
  addEventListener("scroll", () => (tip.hidden = true), { passive: true });
  addEventListener("beforeprint", () => document.querySelectorAll("details.table").forEach((d) => (d.open = true)));
})();
