// SPDX-License-Identifier: BSD-3-Clause
// The view in space: the map coloured by error, the mine, the paths and the lasers' beams, to be turned about.
import { AmbientLight, BackSide, BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, Group, LineBasicMaterial, LineSegments, Line,
         Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { nearest } from './place.js';
import { differences, unpack } from './unpack.js';
import { html } from './words.js';

const laserInks = [0xe69f00, 0x56b4e9, 0x009e73, 0xcc79a7, 0xf0e442, 0xd55e00];

// Metres about the middle of what is shown, so that floats suffice.
class Frame {
  constructor(space) {
    this.low = space.low, this.step = space.step, this.middle = [0, 0, 0];
  }
  metres(value, axis) {
    return this.low[axis] + this.step * value - this.middle[axis];
  }
}

async function readMesh(frame, space, mesh) {
  const bytes = await unpack(mesh.data), n = mesh.vertices, position = new Float32Array(3 * n);
  for (let axis = 0; axis < 3; ++axis) {
    const values = differences(bytes, 2 * n * axis, n, 2);
    for (let k = 0; k < n; ++k) position[3 * k + axis] = frame.metres(values[k], axis);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  let at = 6 * n;
  if (mesh.coloured) {
    const inks = [...space.ramp, '#4d4d4d'].map((hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16)));
    const colour = new Float32Array(3 * n);
    for (let k = 0; k < n; ++k)
      for (let c = 0; c < 3; ++c) colour[3 * k + c] = (inks[bytes[at + k]][c] / 255) ** 2.2;
    geometry.setAttribute('color', new BufferAttribute(colour, 3));
    at += n;
  }
  geometry.setIndex(new BufferAttribute(differences(bytes, at, 3 * mesh.faces, 4), 1));
  geometry.computeVertexNormals();
  return geometry;
}

// Faces look into the rock: seen from outside only the far walls are drawn, which lifts the roof off. With it, both sides.
function asMeshes(geometry, mesh, looks) {
  const group = new Group(), roof = new Group();
  const part = (from, n, side, into) => {
    const share = geometry.clone();
    share.setDrawRange(3 * from, 3 * n);
    into.add(new Mesh(share, new MeshLambertMaterial({ ...looks, side })));
  };
  part(0, mesh.roof, BackSide, group);
  part(mesh.roof, mesh.faces - mesh.roof, DoubleSide, roof);
  group.add(roof);
  return { group, roof };
}

function lineOf(points, colour) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
  return new Line(geometry, new LineBasicMaterial({ color: colour }));
}

// The beams of the moment nearest to the place, as lines from each laser.
async function beamsOf(frame, beams) {
  const from = differences(await unpack(beams.from), 0, 3 * beams.count.length, 2, 3);
  const total = beams.count.reduce((a, b) => a + b, 0), to = differences(await unpack(beams.to), 0, 3 * total, 2, 3);
  const lasers = beams.lasers.length, start = [0];
  for (const n of beams.count) start.push(start[start.length - 1] + n);
  const group = new Group();
  const sets = beams.lasers.map((_, m) => {
    const set = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: laserInks[m % laserInks.length], transparent: true, opacity: 0.75 }));
    group.add(set);
    return set;
  });
  const show = (moment) => {
    for (let m = 0; m < lasers; ++m) {
      const k = moment * lasers + m, points = [];
      for (let b = start[k]; b < start[k + 1]; ++b)
        for (let axis = 0; axis < 3; ++axis) (points[6 * (b - start[k]) + axis] = frame.metres(from[3 * k + axis], axis)), (points[6 * (b - start[k]) + 3 + axis] = frame.metres(to[3 * b + axis], axis));
      sets[m].geometry.dispose();
      sets[m].geometry = new BufferGeometry();
      sets[m].geometry.setAttribute('position', new BufferAttribute(new Float32Array(points), 3));
    }
  };
  return { group, show };
}

class View {
  constructor(canvas, span) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 16 / 9, 0.1, 20 * span);
    this.camera.up.set(0, 0, 1);
    this.lamp = new DirectionalLight(0xffffff, 1.7);
    this.scene.add(new AmbientLight(0xffffff, 1.5), this.lamp);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.ask());
    this.asked = false;
    new ResizeObserver(() => requestAnimationFrame(() => this.fit())).observe(canvas.parentElement);
  }
  fit() {
    const width = this.renderer.domElement.parentElement.clientWidth;
    if (!width) return;
    const height = Math.round(Math.min(0.62 * width + 80, 640));
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.ask();
  }
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.lamp.position.copy(this.camera.position).sub(this.controls.target);
      this.renderer.render(this.scene, this.camera);
    });
  }
  // From a direction, `far` metres from a place.
  look(target, direction, far) {
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction.clone().normalize(), far);
    this.controls.update();
    this.ask();
  }
}

// Arrow keys turn, + and - come nearer and go away.
function useKeys(canvas, view) {
  const turn = (sideways, upward) => {
    const to = view.camera.position.clone().sub(view.controls.target), far = to.length();
    const azimuth = Math.atan2(to.y, to.x) + sideways;
    const elevation = Math.max(-1.5, Math.min(1.5, Math.asin(to.z / far) + upward));
    const flat = Math.cos(elevation);
    view.look(view.controls.target.clone(), new Vector3(flat * Math.cos(azimuth), flat * Math.sin(azimuth), Math.sin(elevation)), far);
  };
  const near = (factor) => {
    const to = view.camera.position.clone().sub(view.controls.target);
    view.look(view.controls.target.clone(), to, to.length() * factor);
  };
  const keys = { ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.08), ArrowDown: () => turn(0, -0.08),
                 '+': () => near(0.85), '=': () => near(0.85), '-': () => near(1.18) };
  canvas.addEventListener('keydown', (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
}

function toggle(name, on, change) {
  const id = `show-${name.toLowerCase().replaceAll(' ', '-')}`;
  return html('label', { for: id }, html('input', { id, type: 'checkbox', checked: on, onchange: (event) => change(event.target.checked) }), ` ${name}`);
}

async function fill(view, data, place, toggles, status) {
  const { space } = data, frame = new Frame(space);
  view.scene.userData.frame = frame;
  const bounds = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  const add = (name, object, on) => {
    object.visible = on;
    view.scene.add(object);
    toggles.append(toggle(name, on, (shown) => { object.visible = shown; view.ask(); }));
  };
  const take = (points) => points.forEach((v, k) => { bounds.low[k % 3] = Math.min(bounds.low[k % 3], v); bounds.high[k % 3] = Math.max(bounds.high[k % 3], v); });
  const roofs = [];
  const addMesh = async (name, mesh, looks, on) => {
    if (!mesh) return;
    const { group, roof } = asMeshes(await readMesh(frame, space, mesh), mesh, looks);
    group.children[0].geometry.computeBoundingBox();
    const { min, max } = group.children[0].geometry.boundingBox;
    take([...min.toArray(), ...max.toArray()]);
    roof.visible = false;
    roofs.push(roof);
    add(name, group, on);
  };
  await addMesh('Map', space.map, { vertexColors: true }, true);
  await addMesh('True mine', space.mine, { color: 0x9a938a, transparent: Boolean(space.map), opacity: space.map ? 0.55 : 1 }, !space.map);
  if (roofs.length)
    toggles.append(toggle('Roof', false, (on) => { roofs.forEach((roof) => { roof.visible = on; }); view.ask(); }));
  if (place) {
    const points = place.path.x.flatMap((x, k) => [x, place.path.y[k], place.path.z[k] + 0.15]);
    take(points);
    add('Mapped path', lineOf(points, 0x0072b2), true);
  }
  if (space.true_path.length > 3) add('True path', lineOf(space.true_path, 0x009e73), false);
  if (space.beams && place) {
    const beams = await beamsOf(frame, space.beams);
    place.onChange((k) => { beams.show(nearest(space.beams.t, place.path.t[k])); view.ask(); });
    add('Lasers', beams.group, true);
  }
  if (place) {
    const mark = new Mesh(new SphereGeometry(0.35, 20, 12), new MeshBasicMaterial({ color: 0xd4007a }));
    view.scene.add(mark);
    place.onChange((k) => { mark.position.set(place.path.x[k], place.path.y[k], place.path.z[k] + 0.4); view.ask(); });
  }
  status.remove();
  return bounds;
}

export function space(data, place) {
  const canvas = html('canvas', { tabindex: 0, role: 'img', 'aria-label': 'View in space of the mapped mine, coloured by error; arrow keys turn it, plus and minus come nearer and go away' });
  const status = html('p', { class: 'status', role: 'status' }, 'Unpacking …');
  const holder = html('div', { class: 'space' }, canvas, status);
  const toggles = html('fieldset', { class: 'toggles' }, html('legend', {}, 'Show'));
  const buttons = html('div', { class: 'buttons' });
  const caption = html('figcaption', {}, `Drag to turn, scroll to come nearer, right button to move. Colours: blue lies in the true rock, red in the true void, ±${data.range} m and more. ` +
    'Surfaces are thinned for the page; without the roof the near walls are left out too. The lasers’ beams are those of the moment at the place on the path.');
  const bar = html('div', { class: 'ramp', 'aria-hidden': 'true' }, html('span', {}, `−${data.range} m`),
    html('i', { style: `background: linear-gradient(90deg, ${data.space.ramp.filter((_, k) => k % 16 === 0 || k === 254).join(',')})` }), html('span', {}, `+${data.range} m`));
  const figure = html('figure', { class: 'view' }, toggles, holder, bar, buttons, caption);
  let view;
  try {
    view = new View(canvas, 1000);
  } catch {
    return [html('p', { class: 'missing' }, 'Not shown: this browser has no WebGL, which the view in space is drawn with. The pictures below show the same.')];
  }
  fill(view, data, place, toggles, status).then(({ low, high }) => {
    const middle = new Vector3(...low.map((v, k) => (v + high[k]) / 2));
    // What fills the picture's width or, laid on its back, its height.
    const span = Math.max((high[0] - low[0]) / view.camera.aspect, 0.8 * (high[1] - low[1])) * 1.6;
    const south = new Vector3(-0.12, -0.75, 0.9), above = new Vector3(0, -0.001, 1);
    const here = () => new Vector3(place.path.x[place.index], place.path.y[place.index], place.path.z[place.index] + 0.8);
    const offer = (words, go) => buttons.append(html('button', { type: 'button', onclick: go }, words));
    offer('From the south', () => view.look(middle, south, 1.05 * span));
    offer('From above', () => view.look(middle, above, 1.2 * span));
    if (place) {
      offer('At the place', () => view.look(here(), south, 26));
      offer('Inside', () => {
        const k = place.index, j = Math.min(place.size - 1, k + 8), i = Math.max(0, j - 16);
        const way = new Vector3(place.path.x[j] - place.path.x[i], place.path.y[j] - place.path.y[i], 0);
        if (way.length() < 1e-6) way.set(1, 0, 0);
        view.look(here().add(way.normalize().multiplyScalar(3)), way.clone().negate(), 3);
      });
    }
    useKeys(canvas, view);
    view.look(middle, south, 1.05 * span);
    holder.dataset.ready = 'yes';
  }, (error) => { status.textContent = `Not shown: ${error.message}`; });
  return [figure];
}
