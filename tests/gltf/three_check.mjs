// SPDX-License-Identifier: MIT
// Compares what libsphmesh-io bakes of a glTF with what three.js shows: every clip, every frame, every vertex.
//   node three_check.mjs MODULES BAKE FPS FILE.glb...
// MODULES is the folder of setup.sh, BAKE the program made of bake.c. Exit 1 where a vertex is off by more than 1e-5 of
// the diagonal of its frame's bounding box.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const LIMIT = 1e-5;
const [modules, bake, fpsText, ...paths] = process.argv.slice(2);
const fps = Number(fpsText);
const load = name => import(pathToFileURL(join(resolve(modules), 'node_modules/three', name)));
// The loader finds three by name, from where it lies itself: both are the same copy.
const THREE = await load('build/three.module.js');
const { GLTFLoader } = await load('examples/jsm/loaders/GLTFLoader.js');

// Pictures cannot be decoded here, and do not move vertices.
function withoutMaterials(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const jsonSize = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonSize)));
  for (const key of ['materials', 'textures', 'images', 'samplers']) delete json[key];
  for (const mesh of json.meshes) for (const primitive of mesh.primitives) delete primitive.material;
  const text = new TextEncoder().encode(JSON.stringify(json));
  const padded = Math.ceil(text.length / 4) * 4;
  const rest = bytes.subarray(20 + jsonSize);
  const out = new Uint8Array(20 + padded + rest.length).fill(0x20);
  out.set(bytes.subarray(0, 20));
  out.set(text, 20);
  out.set(rest, 20 + padded);
  new DataView(out.buffer).setUint32(8, out.length, true);
  new DataView(out.buffer).setUint32(12, padded, true);
  return out.buffer;
}

// The vertices that triangles use, in the order of the file.
function usedVertices(geometry) {
  const used = new Set(geometry.index ? geometry.index.array : Array(geometry.attributes.position.count).keys());
  return [...used].sort((a, b) => a - b);
}

async function check(path) {
  const folder = mkdtempSync(join(tmpdir(), 'sphmesh-gltf-'));
  const out = join(folder, 'frames');
  const clips = JSON.parse(execFileSync(bake, [path, String(fps), out], { encoding: 'utf8' }));
  const bytes = readFileSync(out);
  const ours = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
  rmSync(folder, { recursive: true });

  const gltf = await new GLTFLoader().parseAsync(withoutMaterials(readFileSync(path)), '');
  const meshes = [];
  gltf.scene.traverse(o => { if (o.isMesh) meshes.push({ mesh: o, used: usedVertices(o.geometry) }); });
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const v = new THREE.Vector3();
  let place = 0, worst = 0, frames = 0, vertices = 0;

  for (let c = 0; c < clips.length; ++c) {
    const clip = gltf.animations[c];
    mixer.stopAllAction();
    const action = clip ? mixer.clipAction(clip) : null;
    for (let f = 0; f < clips[c].frames; ++f) {
      if (action) {
        action.reset();
        action.setLoop(THREE.LoopOnce);
        action.clampWhenFinished = true;
        action.play();
        mixer.setTime(Math.min(f / fps, clip.duration));
      }
      gltf.scene.updateMatrixWorld(true);
      const box = new THREE.Box3();
      let off = 0, count = 0;
      for (const { mesh, used } of meshes)
        for (const i of used) {
          mesh.getVertexPosition(i, v).applyMatrix4(mesh.matrixWorld);
          box.expandByPoint(v);
          const p = 3 * count++ + place;
          off = Math.max(off, Math.hypot(v.x - ours[p], v.y - ours[p + 1], v.z - ours[p + 2]));
        }
      if (count !== clips[c].vertices) throw new Error(`${path}: ${clips[c].vertices} vertices, three.js has ${count}`);
      worst = Math.max(worst, off / box.getSize(v).length());
      place += 3 * count;
      vertices = count;
      ++frames;
    }
  }
  if (place !== ours.length) throw new Error(`${path}: ${ours.length - place} floats too many`);
  const good = worst <= LIMIT;
  console.log(`${good ? 'ok' : 'FAILED'}  ${basename(path)}: ${clips.length} clips, ${frames} frames of ${vertices} ` +
    `vertices at ${fps} fps; at most ${worst.toExponential(2)} of the diagonal apart`);
  return good;
}

let good = true;
for (const path of paths) good = await check(path) && good;
process.exit(good ? 0 : 1);
