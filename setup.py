"""Build step of the Python package: CMake builds the program and the compiled laws, setuptools packs them. See pyproject.toml."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


def build_directory():
    """build/release where ./softgrain has built for this Python already; else a directory of this Python's own."""
    release = ROOT / "build" / "release"
    cache = release / "CMakeCache.txt"
    if cache.is_file():
        text = cache.read_text(errors="replace")
        same_python = any(line.startswith(("_Python_EXECUTABLE", "Python_EXECUTABLE")) and
                          os.path.realpath(line.partition("=")[2]) == os.path.realpath(sys.executable) for line in text.splitlines())
        if same_python and f"CMAKE_HOME_DIRECTORY:INTERNAL={ROOT}\n" in text and "pybind11_DIR:PATH=/" in text:
            return release
    return ROOT / "build" / f"python{sys.version_info[0]}.{sys.version_info[1]}"


def copy_scenes(share):
    """The scenes, and the laws that they name, at their places to each other: what `softgrain examples` finds beside the program."""
    scenes = [*ROOT.glob("pipelines/*.toml"), *ROOT.glob("pipelines/*.csv"), ROOT / "pipelines/grainlearning_example/soft_particle.toml"]
    laws = [file for name in ("law.toml", "law_table.toml", "law_table.h5", "cell_law*.toml") for file in ROOT.glob(f"results/*/{name}")
            if (file.parent / "README.md").is_file()]  # folders without a page are runs of this user
    for file in [*scenes, *laws]:
        target = share / file.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(file, target)


class CMakeBuild(build_ext):
    """Runs CMake in place of a compiler; what it needs beside pybind11 is in cmake/packages.txt (./softgrain setup installs it)."""

    def run(self):
        build = build_directory()
        if not (build / "build.ninja").is_file():
            subprocess.run(["cmake", "-S", str(ROOT), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DSOFTGRAIN_TESTS=OFF", "-DSOFTGRAIN_LAMMPS=OFF", "-DSOFTGRAIN_PYTHON=ON",
                            f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "softgrain", "softgrain_python"], check=True)
        module = Path(self.get_ext_fullpath("softgrain._laws"))
        (module.parent / "bin").mkdir(parents=True, exist_ok=True)
        built = next((build / "python" / "softgrain").glob("_laws.*.so"))
        shutil.copy2(built, module)
        shutil.copy2(build / "softgrain", module.parent / "bin" / "softgrain")
        copy_scenes(module.parent / "share" / "softgrain")


# What setuptools notes on the way goes where everything that is built goes.
(ROOT / "build").mkdir(exist_ok=True)
setup(options={"egg_info": {"egg_base": "build"}},
      packages=["softgrain"], package_dir={"softgrain": "pipelines/python/softgrain"},
      ext_modules=[Extension("softgrain._laws", sources=[])], cmdclass={"build_ext": CMakeBuild})
