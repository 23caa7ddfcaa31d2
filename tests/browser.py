"""Headless Chromium, driven over its DevTools protocol by pipes: no port, no package. Standard library only."""
import base64
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time

from cli_fixture import read_png

ARGUMENTS = (
    "--headless", "--no-sandbox", "--no-first-run", "--disable-extensions", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--force-device-scale-factor=1",
    "--force-color-profile=srgb", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe",
)


def chromium():
    """The program's path, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


class Browser:
    """One page. `errors`: what its console and its exceptions said so far."""

    def __init__(self):
        self.errors = []
        self.number = 0
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a child may still write as it ends
        to_read, self.to = os.pipe()
        self.back, to_write = os.pipe()

        def take_pipes():  # it reads from 3 and writes to 4, which may be these pipes' own numbers
            reader, writer = os.dup(to_read), os.dup(to_write)
            os.dup2(reader, 3)
            os.dup2(writer, 4)

        self.process = subprocess.Popen(
            [chromium(), *ARGUMENTS, f"--user-data-dir={self.profile.name}", "about:blank"], preexec_fn=take_pipes,
            close_fds=False, start_new_session=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.buffer = b""
        self.session = None
        targets = self.call("Target.getTargets")["targetInfos"]
        target = next(t["targetId"] for t in targets if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.bringToFront")  # what lies behind draws nothing

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)  # its children too, which write into the profile
        self.process.wait()
        os.close(self.to)
        os.close(self.back)
        self.profile.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def receive(self):
        while b"\0" not in self.buffer:
            more = os.read(self.back, 1 << 16)
            if not more:
                raise AssertionError("the browser has ended")
            self.buffer += more
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def take_event(self, message):
        kind, about = message.get("method"), message.get("params", {})
        if kind == "Runtime.exceptionThrown":
            details = about["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif kind == "Runtime.consoleAPICalled" and about["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(a.get("value", a.get("description", ""))) for a in about["args"]))
        elif kind == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.errors.append(f"{about['entry']['text']} {about['entry'].get('url', '')}")

    def call(self, method, **parameters):
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            request["sessionId"] = self.session
        os.write(self.to, json.dumps(request).encode() + b"\0")
        while True:
            message = self.receive()
            if message.get("id") == self.number:
                if "error" in message:
                    raise AssertionError(f"{method}: {message['error']}")
                return message["result"]
            self.take_event(message)

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def size(self, width, height, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def open(self, url):
        self.call("Page.navigate", url="about:blank")  # else a new fragment alone would not load the page anew
        self.call("Page.navigate", url=url)

    def wait_for(self, expression, seconds=60):
        end = time.monotonic() + seconds

        def holds():
            try:
                return self.evaluate(expression)
            except AssertionError as error:
                if "navigated" not in str(error):
                    raise
                return False  # the page is just being loaded anew

        while not holds():
            if time.monotonic() > end:
                raise AssertionError(f"not in {seconds} s: {expression}; the browser said {self.errors}")
            time.sleep(0.03)

    def screenshot(self):
        """Width, height and RGB bytes; and the PNG itself."""
        png = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        return read_png(png), png

    def picture(self, is_new=lambda shot: True, seconds=10):
        """Width, height and RGB bytes of what is on the screen. What a page has drawn comes there some frames later, many on a
        busy machine: so the first that is new, or the last of so many seconds."""
        end = time.monotonic() + seconds
        while True:
            shot = self.screenshot()[0]
            if is_new(shot) or time.monotonic() > end:
                return shot
