// A static file server for the tests of the page; `slow` sends a file in pieces, so that streaming can be seen.
import {createReadStream, existsSync, readFileSync, statSync} from 'node:fs';
import {createServer} from 'node:http';
import path from 'node:path';

const types = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json'};

export function serve(folder, slow = () => false) {
  const server = createServer(async (request, response) => {
    const file = path.join(folder, decodeURIComponent(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html'));
    if (!existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, {'content-type': types[path.extname(file)] ?? 'application/octet-stream'});
    if (!slow(file)) {
      createReadStream(file).pipe(response);
      return;
    }
    const bytes = readFileSync(file), step = Math.ceil(bytes.length / 12);
    for (let at = 0; at < bytes.length; at += step) {
      response.write(bytes.subarray(at, at + step));
      await new Promise((next) => setTimeout(next, 150));
    }
    response.end();
  });
  return new Promise((ready) => server.listen(0, '127.0.0.1', () => ready({port: server.address().port, close: () => server.close()})));
}
