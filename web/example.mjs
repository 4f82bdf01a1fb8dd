// Presses a body with a ball, 3 mm into its highest point, and prints the force: node web/example.mjs BODY.palpweb
// docs/web.md has the same in C, which prints the same.
import { readFile } from 'node:fs/promises';
import { loadBody, Session } from './index.js';

const body = await loadBody(await readFile(process.argv[2]));
const session = new Session(body);
const { vertices } = session.skin();
let top = 0;
for (let v = 0; v < vertices.length; v += 3) if (vertices[v + 2] > vertices[top + 2]) top = v;
const [x, y, z] = vertices.subarray(top, top + 3);

for (let step = 1; step <= 10; ++step) {
  const centre = [x, y, z + 0.01 - 0.0003 * step];
  session.pressAt([{ id: 1, capsules: [{ a: centre, b: centre, radiusA: 0.01 }] }], step);
}
const [fx, fy, fz] = session.touches[0].force;
console.log(`${fx.toFixed(9)} ${fy.toFixed(9)} ${fz.toFixed(9)} N, ${session.frame.answer}`);
session.close();
body.free();
