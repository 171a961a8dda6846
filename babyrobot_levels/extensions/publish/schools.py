"""What of a course goes into the systems of schools: autograders, and pages that report to them."""

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from functools import lru_cache
from hashlib import sha256
from uuid import NAMESPACE_URL, uuid5
from xml.etree import ElementTree

from babyrobot_levels.extensions.packs.build import Course
from babyrobot_levels.extensions.publish.wheel import wheel
from babyrobot_levels.library.level import Level
from babyrobot_levels.render.templates import html, put_together, static
from babyrobot_levels.text.errors import DISTRIBUTION
from babyrobot_levels.text.files import PACK_FILE

_PYTHON = "3.13"


def _text(name: str, **values: str) -> str:
    """Return a file of the folder `static/schools`, filled in."""
    path = f"extensions/publish/static/schools/{name}.jinja"
    wheel_name, data = packed_wheel()
    return html(
        path,
        distribution=DISTRIBUTION,
        python=_PYTHON,
        wheel=wheel_name,
        sha256=sha256(data).hexdigest(),
        **values,
    )


@lru_cache(maxsize=1)
def packed_wheel() -> tuple[str, bytes]:
    """Return the name of a wheel of this package, and its bytes; empty where there is none."""
    name, files = wheel()
    return name, packed(files) if name else b""


def requirements() -> str:
    """Return what students install by `pip install -r requirements.txt`."""
    name, _ = packed_wheel()
    return f"./{name}\n" if name else f"{DISTRIBUTION}\n"


def github_classroom() -> str:
    """Return the workflow of an assignment, which runs in a copy of the students' code."""
    return _text("github-classroom.yml")


def gradescope(course: Course) -> Mapping[str, bytes]:
    """Return the files of an autograder for Gradescope."""
    results = "/autograder/results/results.json"
    return {
        "setup.sh": _text("setup.sh").encode(),
        "run_autograder": static("extensions/publish/static/schools/run_autograder").encode(),
        "grade.py": _autograder("/autograder/submission", results, "to_gradescope"),
        **_files_of(course),
    }


def classroom50(course: Course) -> Mapping[str, bytes]:
    """Return the files of an autograder for Classroom 50, for the folder of an assignment."""
    return {"autograder.py": _autograder(".", "result.json", "to_classroom50"), **_files_of(course)}


def prairielearn(course: Course, title: str) -> Mapping[str, bytes]:
    """Return the files of a question for PrairieLearn, with its external grader."""
    info = {
        "uuid": str(uuid5(NAMESPACE_URL, course.fields.name)),
        "title": title,
        "topic": "Markov decision processes",
        "type": "v3",
        "singleVariant": True,
        "gradingMethod": "External",
        "externalGradingOptions": {
            "image": f"python:{_PYTHON}-slim",
            "entrypoint": "/grade/tests/grade.py",
            "timeout": 600,
            "enableNetworking": True,
        },
    }
    files = [f"{name}.py" for name in course.fields.functions]
    page = html("extensions/publish/static/prairielearn.html", title=title, files=files)
    script = _autograder("/grade/student", "/grade/results/results.json", "to_prairielearn")
    tests = {"grade.py": script, **_files_of(course)}
    return {
        "info.json": json.dumps(info, indent=2).encode(),
        "question.html": page.encode(),
        **{f"tests/{name}": data for name, data in tests.items()},
    }


def _autograder(code: str, results: str, method: str) -> bytes:
    """Return a script that grades the files in the folder `code`."""
    return _text("grade.py", code=code, results=results, method=method).encode()


def _files_of(course: Course) -> Mapping[str, bytes]:
    """Return what an autograder needs of a course, in the folder `course`."""
    paths = sorted([course.folder / PACK_FILE, *course.files.values(), *course.given.values()])
    names = [f"course/{path.relative_to(course.folder).as_posix()}" for path in paths]
    name, data = packed_wheel()
    own = {name: data} if name else {}
    return own | {name: path.read_bytes() for name, path in zip(names, paths, strict=True)}


def packed(files: Mapping[str, bytes]) -> bytes:
    """Return an archive: the same files give the same bytes."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            info = zipfile.ZipInfo(name)
            is_script = data.startswith(b"#!")
            info.external_attr = (0o100755 if is_script else 0o100644) << 16
            archive.writestr(info, data, zipfile.ZIP_DEFLATED)
    return out.getvalue()


# -- SCORM ---------------------------------------------------------------------------------

_PACKAGING = "http://www.imsproject.org/xsd/imscp_rootv1p1p2"
_SCORM = "http://www.adlnet.org/xsd/adlcp_rootv1p2"


def scorm(levels: Sequence[Level], title: str) -> Mapping[str, bytes]:
    """Return the files of a package of SCORM 1.2: each level is a page that reports its score."""
    files = {"imsmanifest.xml": _manifest(levels, title)}
    files["scorm.js"] = put_together("extensions/publish/static/scorm.js").encode()
    for level in levels:
        page = html("extensions/publish/static/scorm.html", title=level.title or level.name)
        files[f"{level.name}/index.html"] = page.encode()
        files[f"{level.name}/level.html"] = level.to_html(answers=False).encode()
    return files


def _manifest(levels: Sequence[Level], title: str) -> bytes:
    root = ElementTree.Element("manifest", identifier="course", version="1.0", xmlns=_PACKAGING)
    root.set("xmlns:adlcp", _SCORM)
    about = ElementTree.SubElement(root, "metadata")
    ElementTree.SubElement(about, "schema").text = "ADL SCORM"
    ElementTree.SubElement(about, "schemaversion").text = "1.2"
    organizations = ElementTree.SubElement(root, "organizations", default="levels")
    organization = ElementTree.SubElement(organizations, "organization", identifier="levels")
    ElementTree.SubElement(organization, "title").text = title
    resources = ElementTree.SubElement(root, "resources")
    for level in levels:
        item = ElementTree.SubElement(
            organization, "item", identifier=f"item-{level.name}", identifierref=f"of-{level.name}"
        )
        ElementTree.SubElement(item, "title").text = level.title or level.name
        pages = [f"{level.name}/index.html", f"{level.name}/level.html", "scorm.js"]
        resource = ElementTree.SubElement(
            resources, "resource", identifier=f"of-{level.name}", type="webcontent", href=pages[0]
        )
        resource.set("adlcp:scormtype", "sco")
        for page in pages:
            ElementTree.SubElement(resource, "file", href=page)
    ElementTree.indent(root)
    data: bytes = ElementTree.tostring(root, "utf-8", xml_declaration=True)
    return data
