// SPDX-License-Identifier: GPL-3.0-or-later
// The interactive picture: a mesh, and one level of balls around it as a translucent coat.
//
// Everything is drawn twice, first into the depth buffer alone, so that only the outermost surface of the
// balls tints what is behind it however many of them overlap. Drawn on demand: nothing moves by itself.
"use strict";

const kScaleStops = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129],
                     [92, 200, 99], [170, 220, 50], [253, 231, 37]];  // viridis (Smith, van der Walt 2015)

/** The colour of a share in [0, 1] as [r, g, b], each in [0, 1]. */
function scaleColour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (kScaleStops.length - 1);
  const low = Math.min(Math.floor(place), kScaleStops.length - 2);
  return [0, 1, 2].map(
    (k) => (kScaleStops[low][k] + (place - low) * (kScaleStops[low + 1][k] - kScaleStops[low][k])) / 255);
}

function scaleGradient() {
  return "linear-gradient(90deg," + kScaleStops.map((c) => "rgb(" + c.join(",") + ")").join(",") + ")";
}

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes.buffer;
}

const kVertexHead = "varying vec3 vNormal; varying vec3 vView;";
const kFragment = `
  uniform float opacity;
  varying vec3 vNormal;
  varying vec3 vView;
  varying vec3 vTint;
  void main() {
    vec3 n = normalize(vNormal);
    vec3 v = normalize(vView);
    float side = dot(n, v) < 0.0 ? -1.0 : 1.0;
    float key = max(dot(n * side, normalize(vec3(-0.45, 0.65, 0.75))), 0.0);
    float rim = pow(1.0 - abs(dot(n, v)), 3.0);
    vec3 lit = vTint * (0.42 + 0.62 * key) + 0.16 * rim;
    gl_FragColor = vec4(lit, min(1.0, opacity * (0.85 + 0.5 * rim)));
  }`;
// The part of a ball that can be seen: a dome that faces the eye and ends at the outline. `position` holds the
// cosine and sine of the place around it, and how far from the middle to the rim it is.
const kBallVertex = kVertexHead + `
  attribute vec4 ball;
  attribute vec3 tint;
  uniform float grow;
  varying vec3 vTint;
  void main() {
    vec3 centre = (modelViewMatrix * vec4(ball.xyz, 1.0)).xyz;
    float away = length(centre);
    vec3 forth = -centre / away;
    vec3 right = normalize(cross(abs(forth.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), forth));
    vec3 up = cross(forth, right);
    float angle = position.z * acos(min(ball.w / away, 1.0));
    vNormal = cos(angle) * forth + sin(angle) * (position.x * right + position.y * up);
    vec3 p = centre + ball.w * grow * vNormal;
    vView = -p;
    vTint = tint;
    // From inside there is nothing to see.
    gl_Position = away > ball.w ? projectionMatrix * vec4(p, 1.0) : vec4(0.0, 0.0, 2.0, 1.0);
  }`;
const kMeshVertex = kVertexHead + `
  uniform vec3 tint;
  varying vec3 vTint;
  void main() {
    vec4 p = modelViewMatrix * vec4(position, 1.0);
    vNormal = normalMatrix * normal;
    vView = -p.xyz;
    vTint = tint;
    gl_Position = projectionMatrix * p;
  }`;

const kRingVertex = "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }";
const kRingFragment = "uniform vec3 tint; void main() { gl_FragColor = vec4(tint, 1.0); }";

/** A dome (see kBallVertex) of so many sectors and rings. */
function domeGeometry(sectors, rings) {
  const places = [0, 0, 0];
  const corners = [];
  for (let ring = 1; ring <= rings; ++ring) {
    for (let sector = 0; sector < sectors; ++sector) {
      const around = 2 * Math.PI * sector / sectors;
      places.push(Math.cos(around), Math.sin(around), ring / rings);
      const [here, next] = [sector, (sector + 1) % sectors].map((k) => 1 + (ring - 1) * sectors + k);
      if (ring === 1) corners.push(0, here, next);
      else corners.push(here - sectors, here, next, here - sectors, next, next - sectors);
    }
  }
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setIndex(corners);
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
  return geometry;
}

class TreeView {
  /** `view` is the page's data (docs/reports.md); `onPick(place)` is told which ball was clicked, or -1. */
  constructor(box, view, onPick) {
    this.box = box;
    this.onPick = onPick;
    this.centre = view.centre;
    this.size = view.diagonal;
    this.levels = view.levels.map((level) => this.readLevel(level));
    this.level = 0;
    this.selected = -1;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("aria-hidden", "true");
    const wishes = {alpha: true, antialias: true, preserveDrawingBuffer: true};
    // Version 2 needs no extensions, each of which is a wait for the graphics process.
    const context = this.canvas.getContext("webgl2", wishes) || undefined;
    this.renderer = new THREE.WebGLRenderer({...wishes, canvas: this.canvas, context});
    this.renderer.debug.checkShaderErrors = false;  // and so is each question how compiling went
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setClearColor(0x000000, 0);
    box.prepend(this.canvas);
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
    this.scene = new THREE.Scene();
    this.addMesh(view.mesh);
    this.addBalls();
    this.worstRing = this.addRing(5);
    this.ring = this.addRing(6);
    this.reset();
    this.listen();
    new ResizeObserver(() => this.resize()).observe(box);
  }

  /** Coordinates of the scene: the box's centre at the origin, its diagonal 1. */
  readLevel(level) {
    const raw = new Float32Array(bytesOf(level.balls));
    const count = raw.length / 4;
    const balls = new Float32Array(raw.length);
    for (let k = 0; k < count; ++k) {
      for (let axis = 0; axis < 3; ++axis) balls[4 * k + axis] = (raw[4 * k + axis] - this.centre[axis]) / this.size;
      balls[4 * k + 3] = raw[4 * k + 3] / this.size;
    }
    const overhang = new Float32Array(bytesOf(level.overhang));
    let worst = 0;
    for (let k = 1; k < count; ++k) if (overhang[k] > overhang[worst]) worst = k;
    return {
      count, raw, balls, overhang, worst,
      makers: level.makers ? new Uint8Array(bytesOf(level.makers)) : null,
      parents: new Uint32Array(bytesOf(level.parents)),
    };
  }

  addMesh(mesh) {
    const steps = new Uint16Array(bytesOf(mesh.positions));
    const positions = new Float32Array(steps.length);
    for (let k = 0; k < steps.length; ++k) {
      const axis = k % 3;
      positions[k] = (mesh.min[axis] + steps[k] * mesh.step[axis] - this.centre[axis]) / this.size;
    }
    const indices = bytesOf(mesh.triangles);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    const narrow = mesh.index_bytes === 2;
    geometry.setIndex(new THREE.BufferAttribute(narrow ? new Uint16Array(indices) : new Uint32Array(indices), 1));
    geometry.computeVertexNormals();
    this.meshUniforms = {opacity: {value: 1}, tint: {value: new THREE.Color(0xb9bec8)}};
    this.mesh = this.twice(geometry, kMeshVertex, this.meshUniforms, 0, THREE.DoubleSide);
  }

  addBalls() {
    this.ballUniforms = {opacity: {value: 1}, grow: {value: 1}};
    this.balls = null;
  }

  /** Two objects of one geometry: depth, then colour. */
  twice(geometry, vertexShader, uniforms, order, side) {
    const common = {vertexShader, fragmentShader: kFragment, uniforms, transparent: true, side};
    const depth = new THREE.ShaderMaterial({...common, colorWrite: false});
    const colour = new THREE.ShaderMaterial({...common, depthWrite: false, depthFunc: THREE.LessEqualDepth});
    const group = new THREE.Group();
    [depth, colour].forEach((material, k) => {
      const object = new THREE.Mesh(geometry, material);
      object.frustumCulled = false;
      object.renderOrder = order + k;
      group.add(object);
    });
    this.scene.add(group);
    return group;
  }

  addRing(order) {
    const ring = new THREE.Mesh(
      new THREE.RingBufferGeometry(0.985, 1.035, 96),
      new THREE.ShaderMaterial({
        vertexShader: kRingVertex, fragmentShader: kRingFragment, uniforms: {tint: {value: new THREE.Color()}},
        depthTest: false, depthWrite: false, transparent: true}));
    ring.renderOrder = order;
    ring.visible = false;
    this.scene.add(ring);
    return ring;
  }

  setLevel(index) {
    this.level = index;
    this.selected = -1;
    const level = this.levels[index];
    if (this.balls) {
      this.scene.remove(this.balls);
      this.balls.children[0].geometry.dispose();
      for (const object of this.balls.children) object.material.dispose();
    }
    // Few balls are large on the screen and want to look round; many are small.
    const [sectors, rings] =
      level.count <= 16 ? [64, 24] : level.count <= 100 ? [64, 12] : level.count <= 1000 ? [32, 7] : [16, 4];
    const geometry = domeGeometry(sectors, rings);
    // Around the ball, not in it: what the ball holds must not look out between the corners.
    this.ballUniforms.grow.value = 1 / (Math.cos(Math.PI / sectors) * Math.cos(Math.PI / 4 / rings));
    geometry.setAttribute("ball", new THREE.InstancedBufferAttribute(level.balls, 4));
    this.tints = new THREE.InstancedBufferAttribute(new Float32Array(3 * level.count), 3);
    geometry.setAttribute("tint", this.tints);
    geometry.maxInstancedCount = level.count;
    this.balls = this.twice(geometry, kBallVertex, this.ballUniforms, 2, THREE.FrontSide);
    this.setBallOpacity(this.ballUniforms.opacity.value);
    this.draw();
  }

  /** `tint(place)` gives the colour of a ball of the level as [r, g, b]. */
  setTints(tint) {
    for (let k = 0; k < this.levels[this.level].count; ++k) this.tints.array.set(tint(k), 3 * k);
    this.tints.needsUpdate = true;
    this.draw();
  }

  setBallOpacity(value) {
    this.ballUniforms.opacity.value = value;
    if (this.balls) this.balls.visible = value > 0;
    this.draw();
  }

  setMeshOpacity(value) {
    this.meshUniforms.opacity.value = value;
    this.mesh.visible = value > 0;
    this.draw();
  }

  setMarks(worstColour, ringColour) {
    this.worstRing.material.uniforms.tint.value.set(worstColour);
    this.ring.material.uniforms.tint.value.set(ringColour);
    this.draw();
  }

  select(place) {
    this.selected = place;
    this.draw();
  }

  // --- camera ---

  reset() {
    this.yaw = 0.55;
    this.pitch = 0.3;
    this.distance = 1.95;
    this.target = new THREE.Vector3(0, 0, 0);
    this.draw();
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(Math.max(this.pitch + pitch, -1.55), 1.55);
    this.draw();
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.1), 12);
    this.draw();
  }

  /** Turns until the ball faces the viewer, seen from outside. */
  face(place) {
    const b = this.levels[this.level].balls;
    const at = new THREE.Vector3(b[4 * place], b[4 * place + 1], b[4 * place + 2]);
    if (at.length() > 1e-3) {
      this.yaw = Math.atan2(at.x, at.z);
      this.pitch = Math.min(Math.max(Math.asin(at.y / at.length()), -1.2), 1.2);
    }
    this.select(place);
  }

  placeCamera() {
    const c = Math.cos(this.pitch);
    const towards = new THREE.Vector3(c * Math.sin(this.yaw), Math.sin(this.pitch), c * Math.cos(this.yaw));
    this.camera.position.copy(this.target).addScaledVector(towards, this.distance);
    this.camera.lookAt(this.target);
    this.camera.updateMatrixWorld();
  }

  listen() {
    const box = this.box;
    let moved = 0;
    const fingers = new Map();
    box.addEventListener("pointerdown", (event) => {
      moved = 0;
      fingers.set(event.pointerId, event);
      box.setPointerCapture(event.pointerId);
    });
    box.addEventListener("pointermove", (event) => {
      const last = fingers.get(event.pointerId);
      if (!last) return;
      const [dx, dy] = [event.clientX - last.clientX, event.clientY - last.clientY];
      moved += Math.abs(dx) + Math.abs(dy);
      if (fingers.size === 1) {
        this.turn(-0.008 * dx, 0.008 * dy);
      } else {
        const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
        const span = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
        this.zoom(Math.max(span(last), 1) / Math.max(span(event), 1));
      }
      fingers.set(event.pointerId, event);
    });
    box.addEventListener("pointerup", (event) => {
      if (fingers.delete(event.pointerId) && moved < 4) this.onPick(this.ballAt(event.clientX, event.clientY));
    });
    box.addEventListener("pointercancel", (event) => fingers.delete(event.pointerId));
    box.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.0012 * event.deltaY));
    }, {passive: false});
    const keys = {
      ArrowLeft: () => this.turn(-0.12, 0), ArrowRight: () => this.turn(0.12, 0),
      ArrowUp: () => this.turn(0, 0.12), ArrowDown: () => this.turn(0, -0.12),
      "+": () => this.zoom(0.9), "=": () => this.zoom(0.9), "-": () => this.zoom(1 / 0.9), Home: () => this.reset(),
    };
    box.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
  }

  /** The nearest ball under a place of the window, or -1. */
  ballAt(x, y) {
    if (!this.balls.visible) return -1;
    const area = this.canvas.getBoundingClientRect();
    const towards = new THREE.Vector3(2 * (x - area.left) / area.width - 1, 1 - 2 * (y - area.top) / area.height, 0.5);
    towards.unproject(this.camera).sub(this.camera.position).normalize();
    const eye = this.camera.position;
    const {balls, count} = this.levels[this.level];
    let [best, nearest] = [-1, Infinity];
    for (let k = 0; k < count; ++k) {
      const [px, py, pz] = [balls[4 * k] - eye.x, balls[4 * k + 1] - eye.y, balls[4 * k + 2] - eye.z];
      const along = px * towards.x + py * towards.y + pz * towards.z;
      const rest = balls[4 * k + 3] ** 2 - (px * px + py * py + pz * pz - along * along);
      if (rest < 0) continue;
      const distance = along - Math.sqrt(rest);
      if (distance > 0 && distance < nearest) [best, nearest] = [k, distance];
    }
    return best;
  }

  // --- drawing ---

  resize() {
    const {clientWidth, clientHeight} = this.box;
    if (clientWidth === 0 || clientHeight === 0) return;
    if (clientWidth === this.width && clientHeight === this.height) return;
    [this.width, this.height] = [clientWidth, clientHeight];
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.fov = clientWidth < clientHeight ? 32 * clientHeight / clientWidth : 32;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  /** As soon as the browser draws anyway. */
  draw() {
    if (!this.waiting) this.waiting = requestAnimationFrame(() => this.render());
  }

  render() {
    if (this.waiting) cancelAnimationFrame(this.waiting);
    this.waiting = 0;
    if (!this.balls || !this.width) return;
    this.placeCamera();
    const level = this.levels[this.level];
    this.placeRing(this.worstRing, level.worst);
    this.placeRing(this.ring, this.selected === level.worst ? -1 : this.selected);
    this.renderer.render(this.scene, this.camera);
    if (this.onDrawn) this.onDrawn();
  }

  /** Calls back when what was drawn is finished, not only asked for, and the browser has shown it. */
  whenSeen(callback) {
    const gl = this.renderer.getContext();
    const fence = gl.fenceSync ? gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0) : null;
    gl.flush();
    const look = () => {
      if (fence && !gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) {
        setTimeout(look, 10);
      } else {
        requestAnimationFrame(() => requestAnimationFrame(callback));
      }
    };
    setTimeout(look);
  }

  placeRing(ring, place) {
    ring.visible = place >= 0 && this.balls.visible;
    if (!ring.visible) return;
    const b = this.levels[this.level].balls;
    ring.position.set(b[4 * place], b[4 * place + 1], b[4 * place + 2]);
    // The outline of a ball seen from near by is a circle in front of its centre.
    const away = this.camera.position.distanceTo(ring.position);
    const r = b[4 * place + 3];
    if (away > r) ring.position.lerp(this.camera.position, r * r / (away * away));
    ring.scale.setScalar(away > r ? r * Math.sqrt(1 - r * r / (away * away)) : r);
    ring.quaternion.copy(this.camera.quaternion);
  }

  /** Where the top of a ball's outline is, in pixels of the picture. */
  topOf(place) {
    const b = this.levels[this.level].balls;
    const at = new THREE.Vector3(b[4 * place], b[4 * place + 1], b[4 * place + 2]);
    const up = new THREE.Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion);
    at.addScaledVector(up, b[4 * place + 3]).project(this.camera);
    return {x: (at.x + 1) / 2 * this.box.clientWidth, y: (1 - at.y) / 2 * this.box.clientHeight, visible: at.z < 1};
  }
}
