// The packing in 3D, second part: what three.js draws. Grains are squares that face the viewer and look like spheres (their
// depth too), force chains are tubes: one instanced mesh each, so that many thousands turn smoothly.
"use strict";

const packingSphereVertex = `
  attribute vec4 sphere;
  attribute vec3 tint;
  varying vec2 at;
  varying vec3 color;
  varying float middle;
  varying float radius;
  void main() {
    vec4 centre = modelViewMatrix * vec4(sphere.xyz, 1.0);
    at = position.xy;
    color = tint;
    middle = centre.z;
    radius = sphere.w;
    gl_Position = projectionMatrix * (centre + vec4(position.xy * sphere.w, 0.0, 0.0));
  }`;

const packingSphereFragment = `
  uniform vec2 depth;
  uniform float opacity;
  varying vec2 at;
  varying vec3 color;
  varying float middle;
  varying float radius;
  void main() {
    float square = dot(at, at);
    if (square > 1.0) discard;
    vec3 normal = vec3(at, sqrt(1.0 - square));
    float light = 0.5 + 0.5 * max(0.0, dot(normal, vec3(0.32, 0.48, 0.82)));
    float rim = 1.0 - 0.45 * smoothstep(0.86, 1.0, square);
    gl_FragColor = vec4(color * light * rim, opacity);
    gl_FragDepthEXT = 0.5 + 0.5 * (depth.x * (middle + radius * normal.z) + depth.y);
  }`;

const packingShellFragment = `
  uniform vec2 depth;
  varying vec2 at;
  varying vec3 color;
  varying float middle;
  varying float radius;
  void main() {
    float square = dot(at, at);
    if (square > 1.0) discard;
    gl_FragColor = vec4(color, 0.05 + 0.55 * smoothstep(0.93, 0.985, square));
    gl_FragDepthEXT = 0.5 + 0.5 * (depth.x * (middle - radius * sqrt(1.0 - square)) + depth.y);
  }`;

const packingTubeVertex = `
  attribute vec4 begin;
  attribute vec3 end;
  attribute vec3 tint;
  varying vec3 normal3;
  varying vec3 color;
  void main() {
    vec3 along = end - begin.xyz;
    vec3 helper = abs(along.z) > 0.7 * length(along) ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 0.0, 1.0);
    vec3 u = normalize(cross(along, helper));
    vec3 v = normalize(cross(along, u));
    vec3 out3 = u * position.x + v * position.z;
    normal3 = normalMatrix * out3;
    color = tint;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(begin.xyz + along * position.y + out3 * begin.w, 1.0);
  }`;

const packingTubeFragment = `
  varying vec3 normal3;
  varying vec3 color;
  void main() {
    float light = 0.45 + 0.55 * max(0.0, dot(normalize(normal3), vec3(0.32, 0.48, 0.82)));
    gl_FragColor = vec4(color * light, 1.0);
  }`;

/// Arrays of one instanced mesh, filled anew whenever what is shown changes.
function packingInstances(mesh, arrays, count) {
  const geometry = mesh.geometry;
  for (const [name, size, values] of arrays)
    geometry.setAttribute(name, new THREE.InstancedBufferAttribute(values.slice(0, size * count), size));
  geometry.maxInstancedCount = geometry.instanceCount = count; // the name in r111, and the later one
  mesh.visible = count > 0;
}

class PackingScene {
  constructor(canvas) {
    const wish = { antialias: true, preserveDrawingBuffer: true, alpha: false };
    const context = canvas.getContext("webgl2", wish) || canvas.getContext("webgl", wish);
    if (!context) throw new Error("this browser offers no WebGL");
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.setClearColor(0xffffff);
    this.scene = new THREE.Scene();
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
    this.depth = { value: new THREE.Vector2() };
    this.opacity = { value: 1 };
    this.grains = this.squares(packingSphereFragment, { depth: this.depth, opacity: this.opacity }, false);
    this.shells = this.squares(packingShellFragment, { depth: this.depth }, true);
    this.tubes = this.makeTubes();
    this.frame = new THREE.Group();
    this.shells.renderOrder = 2;
    this.scene.add(this.tubes, this.grains, this.frame, this.shells);
  }

  squares(fragmentShader, uniforms, transparent) {
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], 3));
    const material = new THREE.ShaderMaterial({ vertexShader: packingSphereVertex, fragmentShader, uniforms, transparent,
      depthWrite: !transparent, extensions: { fragDepth: true } });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    return mesh;
  }

  makeTubes() {
    const sides = 8;
    const places = [];
    const faces = [];
    for (let k = 0; k < sides; ++k) {
      const angle = (2 * Math.PI * k) / sides;
      for (const y of [0, 1]) places.push(Math.cos(angle), y, Math.sin(angle));
      const next = (k + 1) % sides;
      faces.push(2 * k, 2 * k + 1, 2 * next, 2 * next, 2 * k + 1, 2 * next + 1);
    }
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setIndex(faces);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    const material = new THREE.ShaderMaterial({ vertexShader: packingTubeVertex, fragmentShader: packingTubeFragment,
      side: THREE.DoubleSide });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    return mesh;
  }

  showGrains(state, shown, color, mode, picked) {
    const spheres = new Float32Array(4 * state.count);
    const tint = new Float32Array(3 * state.count);
    let n = 0;
    for (let k = 0; mode !== "off" && k < state.count; ++k) {
      if (!shown[k]) continue;
      spheres.set(state.spheres.subarray(4 * k, 4 * k + 4), 4 * n);
      tint.set(k === picked ? packingPicked : color(state, k), 3 * n);
      ++n;
    }
    const material = this.grains.material;
    this.opacity.value = mode === "faint" ? 0.16 : 1;
    material.transparent = mode === "faint";
    material.depthWrite = mode !== "faint";
    this.grains.renderOrder = mode === "faint" ? 1 : 0;
    packingInstances(this.grains, [["sphere", 4, spheres], ["tint", 3, tint]], n);
  }

  /// Pushing contacts in one colour, pulling ones (cohesion) in another.
  showTubes(state, shown, strong, widest) {
    const begin = new Float32Array(4 * state.contacts);
    const end = new Float32Array(3 * state.contacts);
    const tint = new Float32Array(3 * state.contacts);
    let n = 0;
    for (let c = 0; c < state.contacts && strong > 0; ++c) {
      const i = state.pairs[2 * c];
      const j = state.pairs[2 * c + 1];
      if (!shown[i] || (j < state.count && !shown[j])) continue;
      const force = state.forces[c];
      const width = widest * Math.min(1.5, Math.abs(force) / strong);
      if (width < 0.004 * widest) continue;
      begin.set(state.spheres.subarray(4 * i, 4 * i + 3), 4 * n);
      begin[4 * n + 3] = width;
      end.set(state.ends.subarray(3 * c, 3 * c + 3), 3 * n);
      tint.set(force >= 0 ? [0.8, 0.13, 0.12] : [0.0, 0.52, 0.24], 3 * n);
      ++n;
    }
    packingInstances(this.tubes, [["begin", 4, begin], ["end", 3, end], ["tint", 3, tint]], n);
  }

  showShells(walls, shownBody) {
    const round = walls.filter((w) => w.shape === "sphere" && shownBody(w));
    const spheres = new Float32Array(4 * round.length);
    const tint = new Float32Array(3 * round.length);
    round.forEach((w, n) => {
      spheres.set([...w.point, w.radius], 4 * n);
      tint.set([0.24, 0.3, 0.36], 3 * n);
    });
    packingInstances(this.shells, [["sphere", 4, spheres], ["tint", 3, tint]], round.length);
  }

  /// Edges of the cell or of a box of six planes; single planes as squares.
  showFrame(raw, box) {
    this.frame.remove(...this.frame.children);
    const planes = raw.walls.filter((w) => w.shape === "plane");
    if (raw.cell) return this.addEdges([0, 0, 0], raw.cell);
    if (planes.length >= 6) return this.addBox(planes, box);
    for (const plane of planes) this.addSquare(plane, box);
  }

  addEdges(origin, edges) {
    const corner = (k) => origin.map((o, a) => o + edges.reduce((sum, e, b) => sum + ((k >> b) & 1 ? e[a] : 0), 0));
    const ends = [];
    for (let k = 0; k < 8; ++k)
      for (let b = 0; b < 3; ++b) if (!((k >> b) & 1)) ends.push(...corner(k), ...corner(k | (1 << b)));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
    this.frame.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x6b757e })));
  }

  addBox(planes, box) {
    const low = [...box.low];
    const high = [...box.high];
    for (const p of planes)
      for (let a = 0; a < 3; ++a) {
        if (p.normal[a] > 0.99) low[a] = p.point[a];
        if (p.normal[a] < -0.99) high[a] = p.point[a];
      }
    this.addEdges(low, [0, 1, 2].map((a) => [0, 1, 2].map((b) => (a === b ? high[a] - low[a] : 0))));
  }

  addSquare(plane, box) {
    const middle = new THREE.Vector3(...box.low.map((v, a) => 0.5 * (v + box.high[a])));
    const normal = new THREE.Vector3(...plane.normal);
    const away = normal.clone().multiplyScalar(normal.dot(middle.clone().sub(new THREE.Vector3(...plane.point))));
    const side = 1.15 * Math.max(...box.high.map((v, a) => v - box.low[a]));
    const material = new THREE.MeshBasicMaterial({ color: 0x8a97a3, transparent: true, opacity: 0.28, side: THREE.DoubleSide,
      depthWrite: false });
    const square = new THREE.Mesh(new THREE.PlaneBufferGeometry(side, side), material);
    square.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
    square.position.copy(middle.sub(away));
    square.renderOrder = 3;
    this.frame.add(square);
  }

  /// Looks from (azimuth, elevation) at `target`; `size` is half the height of what is seen, `reach` the half depth.
  draw(view, width, height) {
    const ratio = Math.min(2, Math.max(1.5, window.devicePixelRatio || 1));
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    const camera = this.camera;
    Object.assign(camera, { left: (-view.size * width) / height, right: (view.size * width) / height, top: view.size,
      bottom: -view.size, near: 0, far: 4 * view.reach });
    camera.up.set(0, 0, 1);
    camera.position.set(
      view.target[0] + 2 * view.reach * Math.cos(view.elevation) * Math.cos(view.azimuth),
      view.target[1] + 2 * view.reach * Math.cos(view.elevation) * Math.sin(view.azimuth),
      view.target[2] + 2 * view.reach * Math.sin(view.elevation));
    camera.lookAt(...view.target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.depth.value.set(camera.projectionMatrix.elements[10], camera.projectionMatrix.elements[14]);
    this.renderer.render(this.scene, camera);
  }

  /// The line of sight through a point of the drawing (-1..1): start and direction.
  sight(x, y) {
    const start = new THREE.Vector3(x, y, -1).unproject(this.camera);
    const direction = new THREE.Vector3(0, 0, -1).transformDirection(this.camera.matrixWorld);
    return { start: [start.x, start.y, start.z], direction: [direction.x, direction.y, direction.z] };
  }
}
