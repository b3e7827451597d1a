"""The viewer's one port: page, channels, viser's scene, and who may use it."""

import asyncio
import http.client
import json
import socket
import time
from collections.abc import Iterator

import pytest

pytest.importorskip("viser", reason="needs the extra `view`")

from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from home_mjx.errors import ConfigError
from home_mjx.viewer.browser.serving.channel import Channel
from home_mjx.viewer.browser.serving.front import open_port
from home_mjx.viewer.browser.serving.server import ViewServer


def get(server: ViewServer, path: str = "/", **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=5)
    connection.request("GET", path, headers={"Host": f"localhost:{server.port}", **headers})
    answer = connection.getresponse()
    body = answer.read()
    connection.close()
    return answer.status, body


@pytest.fixture(scope="module")
def pressed() -> list[object]:
    return []


@pytest.fixture(scope="module")
def server(pressed: list[object]) -> Iterator[ViewServer]:
    with ViewServer(port=0, on_key=pressed.append, greeting=lambda: json.dumps({"status": "ready"})) as server:
        yield server


def test_the_page_loads_without_anything_from_elsewhere(server: ViewServer):
    status, page = get(server)
    assert status == 200
    assert b"<iframe" in page
    names = [part.split(b'"')[0].decode() for part in page.split(b'href="')[1:] + page.split(b'src="')[1:]]
    files = [name for name in names if not name.startswith("data:")]
    assert len(files) >= 2
    for name in [*files, "sound.js", "gamepads.js", "worklet.js"]:
        status, data = get(server, f"/{name}")
        assert status == 200
        assert b"://" not in data.replace(b"http://www.w3.org", b"")
    assert get(server, "/scene/")[0] == 200
    assert b"viser" in get(server, "/scene/")[1]
    assert get(server, "/../server.py")[0] == get(server, "/server.py")[0] == 404


def test_channels_carry_messages_both_ways(server: ViewServer, pressed: list[object]):
    with connect(f"ws://localhost:{server.port}/live") as live:
        assert json.loads(live.recv(5)) == {"status": "ready"}
        server.live.publish(b"picture")
        assert live.recv(5) == b"picture"
        live.send("no JSON")
        live.send('["no object"]')
        live.send(json.dumps({"type": "keydown", "key": "w"}))
        wait_until(lambda: pressed)
        assert pressed == [{"type": "keydown", "key": "w", "page": server.live.pages[0]}]
    wait_until(lambda: server.live.num_pages == 0)
    assert pressed[1] == {"type": "leave", "page": pressed[0]["page"]}


def test_viser_s_scene_is_behind_the_same_port(server: ViewServer):
    import viser

    with connect(f"ws://localhost:{server.port}/scene", subprotocols=[f"viser-v{viser.__version__}"]) as scene:
        assert len(scene.recv(5)) > 100


def test_pages_of_other_origins_are_refused(server: ViewServer):
    local = f"localhost:{server.port}"
    assert get(server, Host="evil.example")[0] == 403
    assert get(server, Origin="http://evil.example")[0] == 403
    assert get(server, Origin=f"http://{local}")[0] == 200
    for origin, status in (("http://evil.example", 403), ("http://localhost:1", 403)):
        with pytest.raises(InvalidStatus) as refused, connect(f"ws://{local}/live", origin=origin):
            pass
        assert refused.value.response.status_code == status


def test_other_machines_need_the_token():
    with ViewServer(host="0.0.0.0", port=0) as server:
        token = server.address.rpartition("=")[2]
        assert len(token) >= 16
        assert get(server)[0] == get(server, "/?token=wrong")[0] == get(server, Cookie="home_mjx_token=x")[0] == 403
        assert get(server, f"/?token={token}", Host="192.0.2.1:80")[0] == 200
        assert get(server, "/viewer.js", Cookie=f"home_mjx_token={token}")[0] == 200
        with pytest.raises(InvalidStatus), connect(f"ws://localhost:{server.port}/live"):
            pass


def test_a_taken_port_gives_the_next_free_one():
    with open_port("localhost", 0) as taken:
        number = taken.getsockname()[1]
        with open_port("localhost", number) as following:
            assert number < following.getsockname()[1] < number + 20
    with pytest.raises(ConfigError, match="cannot listen on no-such-host"):
        open_port("no-such-host.invalid", 8080)


def test_requests_that_are_no_http_are_dropped(server: ViewServer):
    for data in (b"\x16\x03\x01\x00\r\n\r\n", b"GET /\r\n\r\n", b"GET / HTTP/1.1\r\n" + b"a" * 100_000):
        with socket.create_connection(("127.0.0.1", server.port), timeout=5) as raw:
            raw.sendall(data)
            raw.shutdown(socket.SHUT_WR)
            answer = raw.recv(100)
            assert not answer.startswith(b"HTTP/1.1 200")
    assert get(server)[0] == 200


def test_slow_pages_lose_the_oldest_data_but_no_text():
    class Slow:
        def __init__(self):
            self.sent, self.gate = [], asyncio.Event()

        async def send(self, message):
            await self.gate.wait()
            self.sent.append(message)

        def __aiter__(self):
            return self

        async def __anext__(self):
            await asyncio.sleep(0.1)
            raise StopAsyncIteration if self.gate.is_set() and len(self.sent) >= 4 else asyncio.CancelledError

    async def run() -> list[object]:
        channel, page = Channel(2), Slow()
        serving = asyncio.create_task(channel.serve(page))
        await asyncio.sleep(0)
        for message in (b"0", "state", b"1", b"2", b"3"):
            channel.publish(message)
        await asyncio.sleep(0.02)
        page.gate.set()
        await asyncio.sleep(0.05)
        serving.cancel()
        await asyncio.gather(serving, return_exceptions=True)
        return page.sent

    sent = asyncio.run(run())
    assert sent[-2:] == [b"2", b"3"]
    assert "state" in sent
    assert len(sent) <= 4


def wait_until(condition, seconds: float = 5.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)
