// A static file server for the tests of the page. `gate` may give a promise for a file: its first `part` bytes are sent
// (by default a third), and the rest when the promise is kept. `slow` gives the milliseconds that a file takes.
// `ranges`: parts of files are sent where they are asked for; `sent` gets the bytes of each answer and its file.
import {existsSync, readFileSync, statSync} from 'node:fs';
import {createServer} from 'node:http';
import path from 'node:path';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.css': 'text/css', '.json': 'application/json'};

export function serve(folder, {gate = () => null, part = (bytes) => Math.ceil(bytes.length / 3), slow = () => 0, ranges = true, sent: note = () => {}} = {}) {
  const server = createServer(async (request, response) => {
    const file = path.join(folder, decodeURIComponent(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html'));
    if (!existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    const wait = slow(file);
    if (wait > 0) await new Promise((next) => setTimeout(next, wait));
    const whole = readFileSync(file), range = ranges && /^bytes=(\d*)-(\d*)$/.exec(request.headers.range ?? ''), opened = gate(file);
    const from = !range ? 0 : range[1] === '' ? Math.max(whole.length - Number(range[2]), 0) : Number(range[1]);
    const to = range && range[1] !== '' && range[2] !== '' ? Math.min(Number(range[2]) + 1, whole.length) : whole.length;
    const bytes = whole.subarray(from, to), type = types[path.extname(file)] ?? 'application/octet-stream';
    note(bytes.length, file);
    response.writeHead(range ? 206 : 200, {'content-type': type, 'content-length': bytes.length,
                                           ...(range ? {'content-range': `bytes ${from}-${to - 1}/${whole.length}`} : {})});
    if (opened === null) {
      response.end(bytes);
      return;
    }
    const sent = part(bytes);
    response.write(bytes.subarray(0, sent));
    await opened;
    response.end(bytes.subarray(sent));
  });
  return new Promise((ready) => server.listen(0, '127.0.0.1', () => ready({port: server.address().port, close: () => server.close()})));
}
