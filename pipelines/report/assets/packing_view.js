// The packing in 3D, third part: what the reader does. Turn by dragging, zoom by wheel or two fingers, shift by dragging with
// the right button; a click on a grain says what it carries.
"use strict";

/// An element with attributes and content.
function packingElement(tag, attributes, ...content) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...content);
  return element;
}

function packingSelect(name, options, chosen) {
  const select = packingElement("select", { name });
  for (const [value, label] of options) {
    const option = packingElement("option", { value }, label);
    option.selected = value === chosen;
    select.append(option);
  }
  return select;
}

class PackingView {
  constructor(root, data) {
    this.root = root;
    this.all = data.series.map((raw) => new PackingSeries(raw));
    this.build();
    this.scene = new PackingScene(this.canvas);
    this.listen();
    this.choose(0);
    new ResizeObserver(() => this.ask()).observe(this.stage);
  }

  build() {
    this.canvas = packingElement("canvas", { tabindex: "0", "aria-label": "Packing in 3D: drag to turn, scroll to zoom, click a grain" });
    this.card = packingElement("div", { class: "card", role: "status" });
    this.scale = packingElement("div", { class: "scale" });
    this.card.hidden = true;
    this.stage = packingElement("div", { class: "stage" }, this.canvas, this.card, this.scale);
    this.which = packingSelect("series", this.all.map((s, k) => [String(k), s.raw.label]), "0");
    this.coloring = packingElement("select", { name: "color" });
    this.mode = packingSelect("grains", [["solid", "solid"], ["faint", "faint"], ["off", "hidden"]], "solid");
    this.chains = packingElement("input", { type: "checkbox", name: "chains" });
    this.axis = packingSelect("cut", [["", "none"], ["0", "x"], ["1", "y"], ["2", "z"]], "");
    this.place = packingElement("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0.5, name: "place", "aria-label": "place of the cut" });
    this.moment = packingElement("input", { type: "range", min: 0, step: 1, name: "state" });
    this.momentText = packingElement("span", {});
    this.momentLabel = packingElement("label", {}, this.momentText, this.moment);
    this.play = packingElement("button", { type: "button", name: "play", "aria-pressed": "false" }, "play");
    this.reset = packingElement("button", { type: "button" }, "reset view");
    const label = (text, ...rest) => packingElement("label", {}, text, ...rest);
    this.root.append(
      packingElement("div", { class: "bar" }, label("state of", this.which), label("colour by", this.coloring), label("grains", this.mode),
        label("force chains", this.chains)),
      this.stage,
      packingElement("div", { class: "bar below" }, this.momentLabel, this.play, label("cut along", this.axis, this.place), this.reset));
  }

  listen() {
    this.which.addEventListener("change", () => this.choose(Number(this.which.value)));
    this.coloring.addEventListener("change", () => this.recolor());
    for (const input of [this.mode, this.chains, this.axis]) input.addEventListener("change", () => this.refill());
    this.place.addEventListener("input", () => this.refill());
    this.moment.addEventListener("input", () => {
      this.stop();
      this.goTo(Number(this.moment.value));
    });
    this.play.addEventListener("click", () => (this.timer ? this.stop() : this.start()));
    this.reset.addEventListener("click", () => this.lookAtAll());
    this.fingers = new Map();
    this.canvas.addEventListener("pointerdown", (e) => this.press(e));
    this.canvas.addEventListener("pointermove", (e) => this.drag(e));
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, (e) => this.release(e));
    this.canvas.addEventListener("contextmenu", (e) => e.preventDefault());
    this.canvas.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    this.canvas.addEventListener("keydown", (e) => this.key(e));
  }

  /// Goes through the recorded states, from the first one where the last is shown, and stops at the last.
  start() {
    const pause = Math.max(120, 4000 / this.series.states); // [ms]
    if (Number(this.moment.value) >= this.series.states - 1) this.show(0);
    this.timer = setInterval(() => {
      this.show(Number(this.moment.value) + 1);
      if (Number(this.moment.value) >= this.series.states - 1) this.stop();
    }, pause);
    this.play.textContent = "stop";
    this.play.setAttribute("aria-pressed", "true");
  }

  stop() {
    clearInterval(this.timer);
    this.timer = undefined;
    this.play.textContent = "play";
    this.play.setAttribute("aria-pressed", "false");
  }

  show(index) {
    this.moment.value = index;
    this.goTo(index);
  }

  choose(index) {
    this.stop();
    this.series = this.all[index];
    const ways = Object.entries(packingColorings).filter(([, way]) => way.there(this.series));
    const before = this.coloring.value;
    this.coloring.replaceChildren(...packingSelect("", ways.map(([name, way]) => [name, way.label]), before).children);
    if (!ways.some(([name]) => name === before)) this.coloring.value = ways[0][0];
    this.box = this.series.box();
    this.moment.max = this.series.states - 1;
    this.moment.value = this.series.states - 1;
    this.moment.hidden = this.play.hidden = this.series.states < 2;
    this.chains.disabled = !this.series.touches();
    this.lookAtAll();
    this.goTo(this.series.states - 1);
    this.recolor();
  }

  goTo(index) {
    this.state = this.series.state(index);
    this.momentText.textContent = this.state.raw.label;
    if (this.picked >= this.state.count) this.picked = -1;
    this.scene.showFrame(this.state.raw, this.box);
    this.refill();
    this.tell();
  }

  recolor() {
    this.colors = packingColoring(this.series, this.coloring.value);
    const scale = this.colors.scale;
    this.scale.replaceChildren(packingElement("span", {}, scale.text));
    if (scale.ramp) {
      const ramp = packingElement("span", { class: "ramp" });
      ramp.style.background = `linear-gradient(to right, ${packingRamp.join(", ")})`;
      this.scale.append(ramp, packingElement("span", { class: "ends" }, ...[scale.low, scale.middle, scale.high].map((t) => packingElement("span", {}, t))));
    }
    this.refill();
  }

  /// Which grains lie behind the cut.
  visible() {
    const shown = new Uint8Array(this.state.count).fill(1);
    if (this.axis.value === "") return shown;
    const a = Number(this.axis.value);
    const at = this.box.low[a] + Number(this.place.value) * (this.box.high[a] - this.box.low[a]);
    for (let k = 0; k < this.state.count; ++k) if (this.state.spheres[4 * k + a] > at) shown[k] = 0;
    return shown;
  }

  refill() {
    if (!this.colors || !this.state) return;
    this.place.disabled = this.axis.value === "";
    this.shown = this.visible();
    this.scene.showGrains(this.state, this.shown, this.colors.color, this.mode.value, this.picked);
    const none = new Uint8Array(this.state.count);
    this.scene.showTubes(this.state, this.chains.checked ? this.shown : none, this.series.strongForce(), 0.012 * this.reach());
    const a = Number(this.axis.value);
    const at = this.box.low[a] + Number(this.place.value) * (this.box.high[a] - this.box.low[a]);
    this.scene.showShells(this.state.walls, (w) => this.axis.value === "" || w.point[a] <= at);
    this.ask();
  }

  reach() {
    return 0.5 * Math.hypot(...this.box.high.map((v, a) => v - this.box.low[a]));
  }

  lookAtAll() {
    const target = this.box.low.map((v, a) => 0.5 * (v + this.box.high[a]));
    // Disks from above, y upwards.
    const [azimuth, elevation] = this.series.state(this.series.states - 1).flat ? [-Math.PI / 2, 1.55] : [-1.15, 0.32];
    this.view = { target, azimuth, elevation, size: 0.88 * this.reach(), reach: 2 * this.reach() };
    this.picked = -1;
    this.tell();
    this.refill();
  }

  /// Draws once, soon, however often it is asked.
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      const { clientWidth: width, clientHeight: height } = this.stage;
      if (width > 0 && height > 0) this.scene.draw(this.view, width, height);
    });
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    this.moved = this.fingers.size > 1 ? Infinity : 0;
  }

  drag(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const dx = now[0] - before[0];
    const dy = now[1] - before[1];
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.fingers.size > 1) {
      const other = [...this.fingers].find(([id]) => id !== event.pointerId)[1];
      const span = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
      this.zoom(span(before) / span(now));
      this.shift(0.5 * dx, 0.5 * dy);
    } else if (event.shiftKey || event.buttons & 6) {
      this.shift(dx, dy);
    } else {
      this.turn(-0.008 * dx, 0.008 * dy);
    }
    this.fingers.set(event.pointerId, now);
  }

  release(event) {
    const there = this.fingers.delete(event.pointerId);
    if (there && event.type === "pointerup" && this.moved < 5) this.pick(event);
  }

  wheel(event) {
    event.preventDefault();
    this.zoom(Math.exp(0.0012 * event.deltaY * (event.deltaMode === 1 ? 16 : 1)));
  }

  key(event) {
    const turns = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (event.key === "+") this.zoom(0.9);
    else if (event.key === "-") this.zoom(1.1);
    else return;
    event.preventDefault();
  }

  turn(right, up) {
    this.view.azimuth += right;
    this.view.elevation = Math.max(-1.55, Math.min(1.55, this.view.elevation + up));
    this.ask();
  }

  zoom(factor) {
    this.view.size = Math.max(0.01 * this.reach(), Math.min(4 * this.reach(), this.view.size * factor));
    this.ask();
  }

  /// Moves what is looked at with the pointer [px].
  shift(dx, dy) {
    const per = (2 * this.view.size) / this.stage.clientHeight;
    const axes = this.scene.camera.matrixWorld.elements;
    this.view.target = this.view.target.map((v, a) => v - per * (dx * axes[a] - dy * axes[4 + a]));
    this.ask();
  }

  /// The foremost grain that is shown under the pointer.
  pick(event) {
    const area = this.canvas.getBoundingClientRect();
    const x = (2 * (event.clientX - area.left)) / area.width - 1;
    const y = 1 - (2 * (event.clientY - area.top)) / area.height;
    const { start, direction } = this.scene.sight(x, y);
    let best = { along: Infinity, k: -1 };
    for (let k = 0; this.mode.value !== "off" && k < this.state.count; ++k) {
      if (!this.shown[k]) continue;
      const p = this.state.position(k).map((v, a) => v - start[a]);
      const along = p[0] * direction[0] + p[1] * direction[1] + p[2] * direction[2];
      const square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - along * along;
      const r = this.state.radius(k);
      if (square > r * r) continue;
      const front = along - Math.sqrt(r * r - square);
      if (front < best.along) best = { along: front, k };
    }
    this.picked = best.k;
    this.tell();
    this.refill();
  }

  /// What is known of the picked grain.
  tell() {
    this.card.hidden = !(this.picked >= 0);
    if (this.card.hidden) return;
    const k = this.picked;
    const state = this.state;
    const raw = this.series.raw;
    const kind = ["solid grain", "soft particle", "grain in a soft particle"][state.role[k]] || "grain";
    const rows = ["radius " + packingQuantity(state.radius(k), raw.length)];
    if (state.role[k] === 2) rows.push("in body " + state.body[k]);
    if (state.contacts > 0) {
      let largest = 0;
      for (let c = 0; c < state.contacts; ++c)
        if (state.pairs[2 * c] === k || state.pairs[2 * c + 1] === k) largest = Math.max(largest, Math.abs(state.forces[c]));
      rows.push("contacts " + state.touching[k], "normal forces, sum " + packingQuantity(state.load[k], raw.force));
      if (largest > 0 || state.touching[k] === 0) rows.push("largest " + packingQuantity(largest, raw.force));
    }
    this.card.replaceChildren(packingElement("b", {}, `${kind} ${state.id(k)}`), ...rows.map((t) => packingElement("div", {}, t)));
  }
}

{
  const root = document.getElementById("packing-view");
  const data = JSON.parse(document.getElementById("packing-data").textContent);
  root.replaceChildren();
  try {
    new PackingView(root, data);
  } catch (error) {
    root.replaceChildren(packingElement("p", {}, "No 3D view: " + error.message + "."));
  }
}
