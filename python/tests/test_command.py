"""The command in the wheel."""

import subprocess
import sys
from pathlib import Path

import zeroset


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "zeroset", *words], capture_output=True, text=True, check=False)


def test_it_is_the_command(tmp_path: Path) -> None:
    assert run("--version").stdout == f"zeroset {zeroset.__version__}\n"
    cloud, mesh = tmp_path / "torus.xyz", tmp_path / "torus.ply"
    assert run("sample", "torus", "--points", "3000", "-o", str(cloud)).returncode == 0
    done = run("reconstruct", str(cloud), "-o", str(mesh), "--quality", "draft")
    assert done.returncode == 0, done.stderr
    assert zeroset.Mesh.load(mesh).is_closed


def test_standard_output_is_complete() -> None:
    done = run("sample", "torus", "--points", "3000", "-o", "-")
    assert done.returncode == 0 and len(done.stdout.splitlines()) >= 3000


def test_exit_codes(tmp_path: Path) -> None:
    missing = run("info", str(tmp_path / "none.ply"))
    assert missing.returncode == 1 and missing.stderr.startswith("error: ") and "no such file" in missing.stderr
    assert run("reconstruct").returncode == 2
