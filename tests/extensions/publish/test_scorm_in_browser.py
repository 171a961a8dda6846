"""The package of SCORM, with scorm-again as the side of the school, in a browser."""

from __future__ import annotations

import base64
import hashlib
import subprocess
import tarfile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import pytest
from support.places import ROOT
from support.sites import hosted

import babyrobot_levels as brl
from babyrobot_levels.extensions.publish.schools import scorm

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = [pytest.mark.slow, pytest.mark.flaky]

RUNTIME = ROOT / ".venv-runtime"
PACKAGE = "scorm-again@3.4.3"
SHA512 = "Zbe+7ArMUbT1lVnqYxsbGRfI9JD9JVqEPzZLQdk0nfNmcDYJ404rMO9nbkQ0Hzwux5uACF9zKsvc29Q/ZzMOdg=="

SCHOOL = """\
<!doctype html>
<script src="scorm12.min.js"></script>
<script>
window.API = new Scorm12API({autocommit: false});
const status = decodeURIComponent(location.search.slice(1)) || "not attempted";
const person = {student_name: "Lovelace, Ada", student_id: "1815"};
API.loadFromJSON({core: {...person, lesson_status: status}}, "cmi");
// As in Moodle, by a rule of SCORM 1.2 that scorm-again does not have.
const finish = API.LMSFinish;
API.LMSFinish = (nothing) => {
  const status = API.lmsGetValue("cmi.core.lesson_status");
  window.ended = status === "not attempted" ? "completed" : status;
  return finish.call(API, nothing);
};
</script>
<iframe src="ADDRESS" style="width: 1000px; height: 800px"></iframe>
"""

LEVELS = ("first-step", "sooner-or-later")


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a package of two levels, and a page of the school for each."""
    folder = tmp_path_factory.mktemp("school")
    levels = [brl.load(ROOT / "course" / "levels" / f"{name}.yaml") for name in LEVELS]
    for path, data in scorm(levels, "A & B").items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(data)
    (folder / "scorm12.min.js").write_bytes(runtime())
    for name in LEVELS:
        text = SCHOOL.replace("ADDRESS", f"{name}/index.html")
        (folder / f"{name}.html").write_text(text, "utf-8")
    return folder


def runtime() -> bytes:
    """Return the script of the school's side, which is fetched once."""
    RUNTIME.mkdir(exist_ok=True)
    archive = RUNTIME / f"{PACKAGE.replace('@', '-')}.tgz"
    if not archive.is_file():
        subprocess.run(["npm", "pack", "--silent", PACKAGE], cwd=RUNTIME, check=True)
    found = hashlib.sha512(archive.read_bytes()).digest()
    assert base64.b64encode(found).decode() == SHA512
    with tarfile.open(archive) as files:
        script = files.extractfile("package/dist/scorm12.min.js")
        assert script is not None
        return script.read()


def told(page: Page, name: str) -> Any:
    return page.evaluate(f"API.lmsGetValue('cmi.{name}')")


def test_the_best_play_is_reported_and_can_be_verified(
    school: Path, browser: Browser, tmp_path: Path
) -> None:
    with hosted(school) as server:
        page = browser.new_page()
        page.goto(f"{server.address}first-step.html")
        stage = page.frame_locator("iframe").frame_locator("iframe").locator("#stage")
        stage.wait_for()
        assert told(page, "core.lesson_status") == "incomplete"
        for key in ["ArrowRight", "ArrowLeft", "ArrowRight", "ArrowRight", "ArrowRight"]:
            stage.press(key)
        page.wait_for_function("API.lmsGetValue('cmi.core.lesson_status') === 'passed'")
        assert told(page, "core.score.raw") == "100"
        assert '"return":-4,' in told(page, "suspend_data")
        # A better play takes its place, and a worse one does not.
        for more in [[], ["ArrowLeft"]]:
            stage.press("r")
            for key in [*more, "ArrowRight", "ArrowRight", "ArrowRight"]:
                stage.press(key)
            page.wait_for_function("API.lmsGetValue('cmi.suspend_data').includes('\"return\":-2,')")
        line = told(page, "suspend_data")
        assert '"player":"Lovelace, Ada (1815)",' in line
        page.evaluate("document.querySelector('iframe').src = 'about:blank'")
        page.wait_for_function("API.isTerminated()")
        assert told(page, "core.score.raw") in ("100", "")
        page.close()
    (tmp_path / "ada.brlplay").write_text(f"{line}\n", "utf-8")
    (grade,) = brl.grade([tmp_path / "ada.brlplay"], ROOT / "course" / "levels" / "first-step.yaml")
    assert grade.fault is None
    assert (grade.episodes, grade.best, grade.success) == (1, -2, 1)


def test_a_level_that_is_not_played_does_not_count_as_completed(
    school: Path, browser: Browser
) -> None:
    with hosted(school) as server:
        page = browser.new_page()
        # Nor does it take back what stands there from another day.
        for before, after in {"not attempted": "incomplete", "passed": "passed"}.items():
            page.goto(f"{server.address}first-step.html?{before}")
            stage = page.frame_locator("iframe").frame_locator("iframe").locator("#stage")
            stage.wait_for()
            page.evaluate("document.querySelector('iframe').src = 'about:blank'")
            page.wait_for_function("window.ended")
            assert page.evaluate("ended") == after
        page.close()


def test_the_manifest_names_all_files_of_each_level(school: Path) -> None:
    root = ElementTree.parse(school / "imsmanifest.xml").getroot()
    names = {"p": "http://www.imsproject.org/xsd/imscp_rootv1p1p2"}
    assert root.find("p:organizations/p:organization/p:title", names) is not None
    resources = root.findall("p:resources/p:resource", names)
    assert [each.get("href") for each in resources] == [f"{name}/index.html" for name in LEVELS]
    kind = "{http://www.adlnet.org/xsd/adlcp_rootv1p2}scormtype"
    assert {each.get(kind) for each in resources} == {"sco"}
    for resource in resources:
        for file in resource.findall("p:file", names):
            assert (school / str(file.get("href"))).is_file()
    items = root.findall("p:organizations/p:organization/p:item", names)
    assert [each.get("identifierref") for each in items] == [e.get("identifier") for e in resources]
