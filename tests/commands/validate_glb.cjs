// Validates every .glb file below a folder with Khronos' gltf-validator, linked images included.
// usage: node validate_glb.cjs NODE_MODULES FOLDER   prints {"files": N, "issues": ["FILE: CODE: MESSAGE"]} of errors
// and warnings
const fs = require('fs');
const path = require('path');
const validator = require(path.join(process.argv[2], 'gltf-validator'));

const filesBelow = (folder) => fs.readdirSync(folder, {withFileTypes: true}).flatMap((entry) => {
  const name = path.join(folder, entry.name);
  return entry.isDirectory() ? filesBelow(name) : [name];
});

const main = async () => {
  const files = filesBelow(process.argv[3]).filter((file) => file.endsWith('.glb')).sort();
  const issues = [];
  for (const file of files) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
      uri: file,
      maxIssues: 0,
      externalResourceFunction: async (uri) =>
        new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
    });
    for (const m of report.issues.messages)
      if (m.severity <= 1) issues.push(`${file}: ${m.code}: ${m.message} ${m.pointer ?? ''}`);
  }
  console.log(JSON.stringify({files: files.length, issues}));
};

main().catch((error) => {
  console.error(String(error));
  process.exit(1);
});
