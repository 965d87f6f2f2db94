"""Headless Chromium, controlled through two pipes by the DevTools protocol."""
import json
import os
import pathlib
import subprocess
import tempfile
import time

FLAGS = [
    "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--no-first-run", "--disable-background-networking", "--disable-dev-shm-usage",
]


class Browser:
    """A browser with one page of a given size [px]."""

    def __init__(self, width, height, name="chromium"):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        read, self.to = os.pipe()
        self.back, write = os.pipe()
        # Chromium reads from descriptor 3 and writes to descriptor 4.
        places = 'exec "$@" 3<&%d 4>&%d' % (read, write)
        line = ["sh", "-c", places, "sh", name, *FLAGS, f"--user-data-dir={self.folder.name}", "about:blank"]
        quiet = subprocess.DEVNULL
        self.child = subprocess.Popen(line, pass_fds=(read, write), stdin=quiet, stdout=quiet, stderr=quiet)
        os.close(read)
        os.close(write)
        self.left, self.calls, self.session = b"", 0, None
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        self.call("Page.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def call(self, method, **params):
        self.calls += 1
        message = {"id": self.calls, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self.left:
                more = os.read(self.back, 1 << 20)
                if not more:
                    raise RuntimeError("the browser has ended")
                self.left += more
            text, self.left = self.left.split(b"\0", 1)
            answer = json.loads(text)
            if answer.get("id") == self.calls:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def value(self, expression):
        """Returns the value of an expression. Awaits promises."""
        done = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in done:
            raise RuntimeError(f"{expression}: {done['exceptionDetails']}")
        return done["result"].get("value")

    def open(self, page):
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=pathlib.Path(page).resolve().as_uri())
        while not self.value("location.protocol === 'file:' && document.body?.dataset.ready === 'yes'"):
            time.sleep(0.1)

    def close(self):
        self.child.kill()
        self.child.wait()
        os.close(self.to)
        os.close(self.back)

    def processor_time(self):
        """Returns the CPU time of all processes of the browser [s]."""
        ticks = sum(self._ticks(pid) for pid in self._family(self.child.pid))
        return ticks / os.sysconf("SC_CLK_TCK")

    def _family(self, pid):
        found = [pid]
        for task in pathlib.Path(f"/proc/{pid}/task").glob("*"):
            try:
                children = (task / "children").read_text().split()
            except OSError:
                continue
            for child in children:
                found += self._family(int(child))
        return found

    @staticmethod
    def _ticks(pid):
        try:
            fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            return 0
        return int(fields[11]) + int(fields[12])
