// node validate.mjs PACKAGES FILE...: what Khronos' validator, of the node_modules folder PACKAGES, says of glTF files:
// one JSON object on standard output, by file name.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const [packages, ...files] = process.argv.slice(2);
const validator = createRequire(join(packages, "of-tests.js"))("gltf-validator");
const said = {};
for (const file of files) said[file] = (await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 100 })).issues;
console.log(JSON.stringify(said));
