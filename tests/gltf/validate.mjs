// SPDX-License-Identifier: MIT
// Runs the Khronos validator on GLB and glTF files; exit 1 where it finds an error or a warning.
//   node validate.mjs MODULES FILE.glb...     MODULES is the folder of setup.sh
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';

const [modules, ...paths] = process.argv.slice(2);
const validator = createRequire(join(resolve(modules), 'package.json'))('gltf-validator');
let good = true;
for (const path of paths) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    maxIssues: 20,
    externalResourceFunction: async uri => new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri)))),
  });
  const fine = issues.numErrors === 0 && issues.numWarnings === 0;
  console.log(`${fine ? 'ok' : 'FAILED'}  ${path}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ` +
    `${issues.numInfos} infos, ${issues.numHints} hints`);
  for (const m of issues.messages) console.log(`    ${m.code} ${m.pointer}: ${m.message}`);
  good = good && fine;
}
process.exit(good ? 0 : 1);
