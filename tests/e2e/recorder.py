"""A proxy on the loopback interface that keeps what passes through it: what real programs ask and are answered."""
import http.client
import http.server
import threading
import urllib.parse
from typing import NamedTuple

HOP_BY_HOP = {"connection", "keep-alive", "transfer-encoding", "content-length", "host"}


class Exchange(NamedTuple):
    method: str
    path: str  # without its query
    status: int
    type: str
    body: bytes


class Recorder(http.server.ThreadingHTTPServer):
    """Serves until close(); bodies are passed on whole, so streams that never end must not come through here."""
    daemon_threads = True

    def __init__(self, target):
        super().__init__(("127.0.0.1", 0), _Handler)
        self.target = urllib.parse.urlsplit(target).netloc
        self.url = "http://127.0.0.1:%d" % self.server_address[1]
        self.exchanges = []
        self._thread = threading.Thread(target=self.serve_forever)
        self._thread.start()

    def close(self):
        self.shutdown()
        self._thread.join()
        self.server_close()


class _Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def pass_on(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        headers = {k: v for k, v in self.headers.items() if k.lower() not in HOP_BY_HOP}
        connection = http.client.HTTPConnection(self.server.target, timeout=60)
        connection.request(self.command, self.path, body, headers)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        path = urllib.parse.urlsplit(self.path).path
        self.server.exchanges.append(
            Exchange(self.command, path, answer.status, answer.headers.get("Content-Type", ""), content))
        self.send_response_only(answer.status)
        for name, value in answer.headers.items():
            if name.lower() not in HOP_BY_HOP:
                self.send_header(name, value)
        if answer.status not in (204, 304):
            self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    do_GET = do_POST = do_PUT = do_DELETE = pass_on
