// A test without a browser: its steps, the folder that they leave, and the status that they end with.
import {rmSync} from 'node:fs';

// Runs each test by its name, on what `prepare` returns, removes the folder and ends the process: 1 where something is thrown.
export async function runTests(folder, tests, prepare = () => undefined) {
  let status = 0;
  try {
    const subject = await prepare();
    for (const test of tests) {
      console.log(test.name);
      await test(subject);
    }
  } catch (error) {
    console.error(`failed: ${error.stack ?? error}`);
    status = 1;
  } finally {
    rmSync(folder, {recursive: true, force: true});
  }
  process.exit(status);
}
