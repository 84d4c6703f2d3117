"""Pages in a browser: no script of a file runs, and a live view refuses foreign pages."""

from __future__ import annotations

import html
import json
import re
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from support.browser import CHROMIUM, page

from fgenv.agents import run_episode
from fgenv.envs import Record, Simulator, policy_of
from fgenv.envs.contact_events import contact_events
from fgenv.scenarios import Scenario

pytest.importorskip("viser")
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from fgenv.view.web.access import Access
from fgenv.view.web.live import Live
from fgenv.view.web.page_security import script_json, with_policy
from fgenv.view.web.replay import write_replay

ATTACK = "document.documentElement.dataset.attacked=1"
HOSTILE = [
    f"</title><script>{ATTACK}</script>",
    f"</script><script>{ATTACK}</script>",
    f"<!--<script>{ATTACK}//",
    f'"><img src=x onerror="{ATTACK}">',
    f"<svg onload={ATTACK}>",
    f"[x](javascript:{ATTACK})",
    f"'-{ATTACK}-'",
    "&lt;b&gt; &amp; \u2028 \u202e",
    f"${{{ATTACK}}}`",
]


def hostile(scenario: Scenario, text: str) -> Scenario:
    """A scenario with a text in every field that takes any."""
    robots = tuple(
        robot.model_copy(update={"name": f"{k}{text}"}) for k, robot in enumerate(scenario.robots)
    )
    bodies = tuple(
        body.model_copy(update={"name": f"b{k}{text}"}) for k, body in enumerate(scenario.bodies)
    )
    changes = {"name": text, "description": text, "robots": robots, "bodies": bodies}
    return scenario.model_copy(update=changes)


def record_of(text: str) -> Record:
    """A record with contacts, and a text in every field."""
    scenario = hostile(Scenario.load("corridor", n=4), text)
    record = run_episode(Simulator(scenario, autoreset=False), policy_of("goto"), steps=30)
    return Record(record.scenario, {**record.about, "policy": text}, record.arrays)


@pytest.fixture(scope="module")
def records() -> list[Record]:
    """Records of all texts, a few at once."""
    return [record_of(" ".join(HOSTILE[k : k + 3])) for k in range(0, len(HOSTILE), 3)]


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_no_script_of_a_record_runs(records: list[Record], tmp_path: Path) -> None:
    with page() as browser:
        for record in records:
            path = tmp_path / "replay.html"
            write_replay(path, record)
            browser.open(path.as_uri())
            browser.wait("document.querySelector('[role=\"slider\"]')")
            browser.wait("document.querySelector('.fgenv-mark')")
            assert not browser.run("document.documentElement.dataset.attacked")
            assert browser.run("document.title") == f"{record.scenario.name} - fgenv"
            heading = browser.run("document.querySelector('#fgenv-head b').textContent")
            assert heading == f"{record.scenario.name}: 4 robots, {record.policy}"
            titles = browser.run("[...document.querySelectorAll('.fgenv-mark')].map(m => m.title)")
            assert all(e.text in t for e, t in zip(contact_events(record), titles, strict=True))
        assert browser.errors == []


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_the_policy_of_a_page_stops_injected_scripts(records: list[Record], tmp_path: Path) -> None:
    """The test's attack works without the policy, so its absence above means something."""
    path = tmp_path / "replay.html"
    write_replay(path, records[0])
    text = path.read_text()
    injected = text.replace(
        "<div id=", f"<script>{ATTACK}</script><img src=x onerror={ATTACK}><div id="
    )
    open_page = re.sub(r"<meta http-equiv=.Content-Security-Policy[^>]*>", "", injected)
    with page() as browser:
        for content, attacked in ((open_page, "1"), (injected, None)):
            path.write_text(content)
            browser.open("about:blank")
            browser.open(path.as_uri())
            browser.wait("document.querySelector('[role=\"slider\"]')")
            assert browser.run("document.documentElement.dataset.attacked") == attacked


@pytest.mark.parametrize("text", HOSTILE)
def test_data_of_a_script_is_equal_and_has_no_markup(text: str) -> None:
    data = script_json({text: [text, 0.5, None]})
    assert not set("<>&\u2028\u2029") & set(data)
    assert json.loads(data) == {text: [text, 0.5, None]}


def test_the_policy_comes_before_any_script() -> None:
    with pytest.raises(ValueError, match="charset"):
        with_policy('<html><head><script>1</script><meta charset="utf-8" /></head>')
    text = with_policy('<html><meta charset="utf-8" /><title>&lt;</title><script>1</script></html>')
    assert text.index("Content-Security-Policy") < text.index("<title>")
    assert "'unsafe-inline'" not in text.partition("script-src")[2].partition(";")[0]
    assert html.escape("<") in text


@pytest.fixture(scope="module")
def simulator() -> Simulator:
    simulator = Simulator("swap", n=2, autoreset=False)
    simulator.reset(seed=0)
    return simulator


@pytest.fixture(scope="module")
def local(simulator: Simulator) -> Iterator[Live]:
    live = Live(simulator, 0)
    yield live
    live.close()


@pytest.fixture(scope="module")
def shared(simulator: Simulator) -> Iterator[Live]:
    live = Live(simulator, 0, host="127.0.0.1")
    yield live
    live.close()


def get(live: Live, path: str = "/", **headers: str) -> tuple[int, Any]:
    """Status and headers of a request."""
    url = f"http://127.0.0.1:{live.server.get_port()}{path}"
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers)) as answer:
            return answer.status, answer.headers
    except urllib.error.HTTPError as error:
        return error.code, error.headers


def socket_opens(live: Live, path: str = "/", **headers: str) -> bool:
    """Whether a web socket opens with these headers."""
    port = live.server.get_port()
    host = headers.pop("Host", f"127.0.0.1:{port}")
    try:
        with connect(
            f"ws://{host}{path}",
            sock=socket.create_connection(("127.0.0.1", port)),
            additional_headers=headers,
            subprotocols=[Subprotocol("viser-v1.1.1")],
        ):
            return True
    except InvalidStatus as error:
        if error.response.status_code != HTTPStatus.FORBIDDEN:
            raise
        return False


def test_a_local_view_accepts_its_own_page(local: Live) -> None:
    port = local.server.get_port()
    for name in ("127.0.0.1", "localhost", "LOCALHOST", "[::1]"):
        host = f"{name}:{port}"
        assert get(local, Host=host)[0] == 200
        assert socket_opens(local, Host=host, Origin=f"http://{host}")
    assert socket_opens(local)  # a program, not a page
    assert get(local)[1]["X-Frame-Options"] == "DENY"


def test_a_local_view_refuses_foreign_pages_and_names(local: Live) -> None:
    port = local.server.get_port()
    for origin in (
        "http://evil.example",
        "null",
        f"http://evil.example:{port}",
        f"http://127.0.0.1:{port + 1}",
        f"http://localhost:{port}",  # another origin than 127.0.0.1
        f"http://127.0.0.1:{port}.evil.example",
        "file://",
    ):
        assert not socket_opens(local, Origin=origin), origin
        assert get(local, Origin=origin)[0] == 403
    for host in (
        "evil.example",
        f"evil.example:{port}",
        f"localhost.evil.example:{port}",
        f"127.0.0.1.evil.example:{port}",
        f"evil@127.0.0.1:{port}",
        f"127.0.0.1:{port + 1}",
        "127.0.0.1:x",
        "[::1",
        "127.0.0.1",  # port 80
    ):
        assert get(local, Host=host)[0] == 403, host
    assert not socket_opens(local, Host=f"evil.example:{port}")


def test_a_shared_view_needs_the_token(shared: Live) -> None:
    address = urlsplit(shared.url)
    with_token, port = f"/?{address.query}", shared.server.get_port()
    assert len(address.query) > 25
    for path in ("/", "/?token=", "/?token=x", "/?token=%C3%A9", "/?token=%FF"):
        assert get(shared, path)[0] == 403
        assert not socket_opens(shared, path)
    status, headers = get(shared, with_token, Host="robots.example")
    assert status == 200
    cookie = headers["Set-Cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    own = cookie.partition(";")[0]
    assert get(shared, Cookie=own)[0] == 200
    assert socket_opens(shared, Cookie=f"a=b; {own}", Origin=f"http://127.0.0.1:{port}")
    assert not socket_opens(shared, Cookie=own, Origin="http://evil.example")
    assert get(shared, Cookie=own[:-1])[0] == 403


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("kind", ["local", "shared"])
def test_a_browser_connects(kind: str, request: pytest.FixtureRequest) -> None:
    live: Live = request.getfixturevalue(kind)
    with page() as browser:
        browser.open(live.url)
        browser.wait("document.body && document.body.innerText.includes('New episode')")


def test_rules_compare_origin_and_host() -> None:
    from websockets.datastructures import Headers

    both = Headers([("Host", "localhost:1"), ("Host", "evil")])
    assert Access().refusal(both, "/", 1)
    assert Access().refusal(Headers(), "/", 1)
    assert Access("t").refusal(Headers([("Host", "a"), ("Cookie", "fgenv-1=é;;")]), "/", 1)
