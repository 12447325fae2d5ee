// The packing in 3D, first part: states out of the page, what is known of every grain, colours.
// The states stand in the page as one JSON object (packing_data.cpp): numbers of grains as base64 of little-endian arrays.
"use strict";

const packingPalette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// Dark to light, even in lightness, the same for all who tell colours apart or not.
const packingRamp = ["#3b1f63", "#3e4a89", "#2f6f8e", "#21918c", "#35b779", "#8fd744", "#fde725"];
const packingIdle = [0.82, 0.84, 0.86]; // grains that carry nothing
const packingPicked = [0.86, 0.1, 0.45];

function packingArray(text, Type) {
  if (!text) return new Type(0);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  return new Type(bytes.buffer);
}

function packingColor(hex) {
  return [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
}

const packingRampColors = packingRamp.map(packingColor);

function packingRampAt(share) {
  const at = Math.min(1, Math.max(0, share)) * (packingRamp.length - 1);
  const k = Math.min(packingRamp.length - 2, Math.floor(at));
  return packingRampColors[k].map((v, c) => v + (at - k) * (packingRampColors[k + 1][c] - v));
}

/// A number with its unit; metres and newtons with a prefix that suits it.
function packingQuantity(value, unit) {
  const round = (v) => String(Number(v.toPrecision(3))).replace("-", "\u2212");
  if (value === 0) return "0 " + unit;
  if (unit !== "m" && unit !== "N" && unit !== "s") return round(value) + " " + unit;
  const prefixes = [["\u00b5", 1e-6], ["m", 1e-3], ["", 1], ["k", 1e3], ["M", 1e6]];
  const size = Math.abs(value);
  let best = ["n", 1e-9];
  for (const p of prefixes) if (size >= 0.9995 * p[1]) best = p;
  return round(value / best[1]) + " " + best[0] + unit;
}

/// One state with its arrays: places, radii, contacts, and what follows from them for every grain.
class PackingState {
  constructor(raw, series) {
    this.raw = raw;
    this.series = series;
    this.count = raw.grains;
    this.spheres = packingArray(raw.spheres, Float32Array); // x, y, z, radius
    this.body = raw.body ? packingArray(raw.body, Int32Array) : new Int32Array(this.count);
    this.role = raw.role ? packingArray(raw.role, Uint8Array) : new Uint8Array(this.count);
    this.ids = packingArray(raw.ids, Int32Array);
    this.pairs = packingArray(raw.pairs, Int32Array); // i, j; j beyond the grains is a wall
    this.forces = packingArray(raw.forces, Float32Array);
    this.contacts = this.forces.length;
    this.walls = raw.walls;
    this.flat = this.count > 1 && this.spheres.every((v, k) => k % 4 !== 2 || v === this.spheres[2]);  // disks
    this.findEnds();
    this.gather();
  }

  /// Ends of the lines of contacts: centres of the second grains, but for walls and images across the cell.
  findEnds() {
    this.ends = new Float32Array(3 * this.contacts);
    for (let c = 0; c < this.contacts; ++c) {
      const j = this.pairs[2 * c + 1];
      if (j < this.count) this.ends.set(this.spheres.subarray(4 * j, 4 * j + 3), 3 * c);
    }
    const bent = packingArray(this.raw.bent, Int32Array);
    const ends = packingArray(this.raw.ends, Float32Array);
    bent.forEach((c, k) => this.ends.set(ends.subarray(3 * k, 3 * k + 3), 3 * c));
  }

  /// Contacts per grain, and the sum of their normal forces; the page has them where it lacks some contacts.
  gather() {
    if (this.raw.load) {
      this.touching = packingArray(this.raw.touching, Uint16Array);
      this.load = packingArray(this.raw.load, Float32Array);
      return;
    }
    this.touching = new Uint16Array(this.count);
    this.load = new Float32Array(this.count);
    for (let c = 0; c < this.contacts; ++c) {
      const force = Math.abs(this.forces[c]);
      for (const k of [this.pairs[2 * c], this.pairs[2 * c + 1]]) {
        if (k >= this.count) continue;
        this.touching[k] += 1;
        this.load[k] += force;
      }
    }
  }

  position(k) {
    return [this.spheres[4 * k], this.spheres[4 * k + 1], this.spheres[4 * k + 2]];
  }
  radius(k) {
    return this.spheres[4 * k + 3];
  }
  id(k) {
    return this.ids.length > 0 ? this.ids[k] : k;
  }
}

/// A series of states, decoded when they are first shown.
class PackingSeries {
  constructor(raw) {
    this.raw = raw;
    this.decoded = new Map();
  }
  get states() {
    return this.raw.states.length;
  }
  state(index) {
    if (!this.decoded.has(index)) this.decoded.set(index, new PackingState(this.raw.states[index], this.raw));
    return this.decoded.get(index);
  }

  /// Least and largest of a value over all states, so that a colour means the same in each.
  range(value) {
    let low = Infinity;
    let high = 0;
    for (let s = 0; s < this.states; ++s) {
      const state = this.state(s);
      for (let k = 0; k < state.count; ++k) {
        const v = value(state, k);
        if (v > high) high = v;
        if (v > 0 && v < low) low = v;
      }
    }
    return [Math.min(low, high), high];
  }

  /// Whether any state has contacts.
  touches() {
    return this.raw.states.some((state) => state.forces !== "");
  }

  /// A force that few contacts exceed, in the last state that has any: the measure of tubes.
  strongForce() {
    if (this.strong === undefined) {
      const forces = [];
      let index = this.states - 1;
      while (index > 0 && this.raw.states[index].forces === "") --index;
      const last = this.state(index);
      for (let c = 0; c < last.contacts; ++c) forces.push(Math.abs(last.forces[c]));
      forces.sort((a, b) => a - b);
      this.strong = forces.length > 0 ? forces[Math.floor(0.98 * (forces.length - 1))] : 0;
    }
    return this.strong;
  }

  box() {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let s = 0; s < this.states; ++s) {
      const state = this.state(s);
      for (let k = 0; k < state.count; ++k) {
        const r = state.radius(k);
        state.position(k).forEach((x, a) => {
          low[a] = Math.min(low[a], x - r);
          high[a] = Math.max(high[a], x + r);
        });
      }
    }
    return { low, high };
  }
}

/// The ways to colour grains: name, value of a grain, whether it is there at all, how shares of the ramp follow.
const packingColorings = {
  force: {
    label: "force",
    text: (s) => "sum of the normal forces on a grain",
    value: (state, k) => state.load[k],
    there: (series) => series.touches(),
    log: true,
    unit: (raw) => raw.force,
  },
  radius: {
    label: "radius",
    text: () => "radius",
    value: (state, k) => state.radius(k),
    there: () => true,
    log: true,
    unit: (raw) => raw.length,
  },
  contacts: {
    label: "number of contacts",
    text: () => "contacts of a grain that carry force",
    value: (state, k) => state.touching[k],
    there: (series) => series.touches(),
    log: false,
    unit: () => "",
  },
  body: {
    label: "body",
    text: () => "grey: solid grains; colours: soft particles",
    there: (series) => new Set(series.state(0).body).size > 1,
  },
};

/// A function (state, grain) -> colour, and what the scale shows: {low, high, text} or only {text}.
function packingColoring(series, name) {
  const way = packingColorings[name];
  const scale = { text: way.text(series) };
  if (name === "body") {
    const shades = packingPalette.map(packingColor).map((c) => c.map((v) => 0.25 + 0.75 * v));
    return { scale, color: (state, k) => (state.role[k] === 0 ? [0.72, 0.74, 0.77] : shades[state.body[k] % shades.length]) };
  }
  const [least, high] = series.range(way.value);
  let low = name === "force" ? Math.max(least, 1e-3 * high) : least;
  if (!way.log) low = 0;
  const along = way.log ? Math.log : (v) => v;
  const width = along(high) - along(low);
  const share = (v) => (width > 0 ? (along(Math.max(v, low)) - along(low)) / width : 0.5);
  const unit = way.unit(series.raw);
  Object.assign(scale, { low: packingQuantity(low, unit), high: packingQuantity(high, unit), ramp: true,
    middle: way.log && high > 4 * low ? packingQuantity(Math.sqrt(low * high), unit) : "" });
  if (low > least) scale.low = "\u2264 " + scale.low;
  return { scale, color: (state, k) => (way.value(state, k) > 0 ? packingRampAt(share(way.value(state, k))) : packingIdle) };
}
