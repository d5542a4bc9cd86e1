// SPDX-License-Identifier: MIT
// Compares what three.js makes of rigs with what the library does: every clip, every frame, every vertex.
//   node three_rigs.mjs MODULES RIGS.json
// MODULES is the folder of setup.sh, RIGS.json has the lines of rigs.c. Exit 1 where a vertex is off by more than 1e-5 of the
// mean diagonal of the bounding boxes.
import { readFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const LIMIT = 1e-5;
const [modules, list] = process.argv.slice(2);
const load = name => import(pathToFileURL(join(resolve(modules), 'node_modules/three', name)));
const THREE = await load('build/three.module.js');
const { GLTFLoader } = await load('examples/jsm/loaders/GLTFLoader.js');
// It would scale the first set's weights to a sum of one: right where there is one set only, and then without effect here.
THREE.SkinnedMesh.prototype.normalizeSkinWeights = () => {};
globalThis.ProgressEvent ??= class { constructor(type, of) { Object.assign(this, of, { type }); } };

// Files beside a .gltf cannot be fetched here: they go into it.
function wholeFile(path) {
  const bytes = readFileSync(path);
  if (path.endsWith('.glb')) return bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const json = JSON.parse(bytes);
  for (const buffer of json.buffers) {
    const beside = readFileSync(join(dirname(path), decodeURIComponent(buffer.uri)));
    if (beside.length !== buffer.byteLength) throw new Error(`${buffer.uri}: ${beside.length} bytes`);
    buffer.uri = `data:application/octet-stream;base64,${beside.toString('base64')}`;
  }
  return JSON.stringify(json);
}

async function check(rig) {
  const bytes = readFileSync(rig.frames);
  const ours = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  const gltf = await new GLTFLoader().parseAsync(wholeFile(rig.rig), '');
  const meshes = [];
  gltf.scene.traverse(o => { if (o.isSkinnedMesh) meshes.push(o); });
  if (meshes.length !== 1) throw new Error(`${rig.rig}: ${meshes.length} skinned meshes`);
  const [mesh] = meshes;
  const size = 3 * rig.vertices;
  // three.js has four influences to a vertex: of a file with more it takes the first set alone, which is not the rig.
  const geometry = mesh.geometry;
  const sets = [[geometry.attributes.skinIndex, geometry.attributes.skinWeight]];
  for (let n = 1; geometry.attributes[`joints_${n}`]; ++n)
    sets.push([geometry.attributes[`joints_${n}`], geometry.attributes[`weights_${n}`]]);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const v = new THREE.Vector3(), p = new THREE.Vector3(), sum = new THREE.Vector3(), m = new THREE.Matrix4();
  const place = i => {
    if (sets.length === 1) return mesh.getVertexPosition(i, v).applyMatrix4(mesh.matrixWorld);
    p.fromBufferAttribute(geometry.attributes.position, i).applyMatrix4(mesh.bindMatrix);
    sum.set(0, 0, 0);
    for (const [joints, weights] of sets)
      for (let k = 0; k < 4; ++k) {
        const bone = joints.getComponent(i, k), weight = weights.getComponent(i, k);
        if (weight === 0) continue;
        m.multiplyMatrices(mesh.skeleton.bones[bone].matrixWorld, mesh.skeleton.boneInverses[bone]);
        sum.addScaledVector(v.copy(p).applyMatrix4(m), weight);
      }
    return v.copy(sum).applyMatrix4(mesh.bindMatrixInverse).applyMatrix4(mesh.matrixWorld);
  };
  if (geometry.attributes.position.count !== rig.vertices) throw new Error(`${rig.rig}: other vertices`);
  let at = 0, worst = 0, diagonals = 0, frames = 0;
  if (gltf.animations.length !== rig.clips.length) throw new Error(`${rig.rig}: ${gltf.animations.length} clips`);
  rig.clips.forEach((clip, c) => {
    if (gltf.animations[c].name !== clip.name) throw new Error(`${rig.rig}: a clip ${gltf.animations[c].name}`);
    mixer.stopAllAction();
    const action = mixer.clipAction(gltf.animations[c]);
    for (let f = 0; f < clip.frames; ++f, ++frames, at += size) {
      action.reset();
      action.setLoop(THREE.LoopOnce);
      action.clampWhenFinished = true;
      action.play();
      mixer.setTime(Math.min(Math.fround(f / rig.fps), gltf.animations[c].duration));
      gltf.scene.updateMatrixWorld(true);
      mesh.skeleton.update();
      const box = new THREE.Box3();
      for (let i = 0; i < rig.vertices; ++i) {
        const q = place(i);
        box.expandByPoint(q);
        worst = Math.max(worst, Math.hypot(q.x - ours[at + 3 * i], q.y - ours[at + 3 * i + 1], q.z - ours[at + 3 * i + 2]));
      }
      diagonals += box.getSize(v).length();
    }
  });
  if (at !== ours.length) throw new Error(`${rig.rig}: ${ours.length - at} floats too many`);
  worst /= diagonals / frames;
  const good = worst <= LIMIT;
  console.log(`${good ? 'ok' : 'FAILED'}  ${basename(rig.rig)}: ${rig.clips.length} clips, ${frames} frames of ` +
    `${rig.vertices} vertices on ${mesh.skeleton.bones.length} joints; at most ${worst.toExponential(2)} of the diagonal apart`);
  return good;
}

let good = true;
for (const line of readFileSync(list, 'utf8').trim().split('\n')) good = await check(JSON.parse(line)) && good;
process.exit(good ? 0 : 1);
