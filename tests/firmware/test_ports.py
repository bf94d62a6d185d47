"""What goes around a library: CMake package, Arduino and PlatformIO library, Zephyr module."""

import json
import re
import shutil

import pytest

from boards.firmware.native import run
from innervate.firmware import library
from tests.firmware.made import files_of

USER = """cmake_minimum_required(VERSION 3.16)
project(user LANGUAGES C)
find_package(innervate_skin REQUIRED)
add_executable(user main.c)
target_link_libraries(user PRIVATE innervate::skin)
"""
MAIN = """#include "skin_node.h"
#include <stdio.h>
static int32_t port_now(void *user) { (void)user; return 0; }
static int32_t port_send(void *user, int32_t port, const uint8_t *bytes, int32_t count)
{
    (void)user; (void)port; (void)bytes;
    return count;
}
int main(void)
{
    static skin_node_t node;
    static const innervate_port_t port = {port_now, port_send, 0, 0, 0, 0};
    skin_node_start(&node, &skin_defaults, &port, 7, 1, 0);
    skin_node_poll(&node);
    printf("%d %d %s\\n", node.state.number, node.due[0], SKIN_SOURCE);
    return 0;
}
"""
ARDUINO = """#include <stddef.h>
#include <stdint.h>
struct HardwareSerial {
    void begin(long) {}
    int availableForWrite() { return 9; }
    size_t write(const uint8_t *, size_t count) { return count; }
    int available() { return 0; }
    int read() { return 0; }
};
static HardwareSerial Serial1, Serial2;
static unsigned long micros() { return 0; }
"""


@pytest.fixture
def cmake():
    """CMake, and what it needs."""
    for tool in ("cmake", "gcc", "make"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder, files = tmp_path_factory.mktemp("lib"), files_of("skin")
    library.write(files, folder)
    return files.library, folder


@pytest.mark.usefixtures("cmake")
def test_a_cmake_package_is_installed_and_found(made, tmp_path):
    skin, folder = made
    (tmp_path / "CMakeLists.txt").write_text(USER)
    (tmp_path / "main.c").write_text(MAIN)
    run(["cmake", "-S", folder, "-B", tmp_path / "lib"])
    run(["cmake", "--build", tmp_path / "lib"])
    run(["cmake", "--install", tmp_path / "lib", "--prefix", tmp_path / "there"])
    run(["cmake", "-S", tmp_path, "-B", tmp_path / "user",
         f"-DCMAKE_PREFIX_PATH={tmp_path / 'there'}"])  # fmt: skip
    run(["cmake", "--build", tmp_path / "user"])
    assert run([tmp_path / "user/user"]).split() == ["7", "20000", skin.digest()]


def test_an_arduino_sketch_compiles_against_what_it_uses_of_arduino(made, tmp_path):
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed")
    _, folder = made
    sketch = (folder / "examples/skin_node/skin_node.ino").read_text()
    (tmp_path / "sketch.cpp").write_text(ARDUINO + sketch)
    run(["g++", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function", "-fsyntax-only",
         "-I", folder, tmp_path / "sketch.cpp"])  # fmt: skip


# Of an Arduino library, as arduino.github.io/arduino-cli/library-specification has them.
ASKED = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
         "architectures"}  # fmt: skip
# Of a module.yml, as docs.zephyrproject.org/latest/develop/modules.html has it.
MODULE = {"name", "build"}
BUILD = {"cmake", "kconfig"}


# Of Zephyr what a module's CMakeLists.txt calls, as its cmake/modules/extensions.cmake has it.
ZEPHYR = """cmake_minimum_required(VERSION 3.20)
project(user LANGUAGES C)
add_library(zephyr_interface INTERFACE)
macro(zephyr_library)
  set(ZEPHYR_CURRENT_LIBRARY made)
  add_library(made STATIC "")
  target_link_libraries(made PUBLIC zephyr_interface)
endmacro()
function(zephyr_library_sources source)
  target_sources(${ZEPHYR_CURRENT_LIBRARY} PRIVATE ${source} ${ARGN})
endfunction()
function(zephyr_include_directories)
  foreach(arg ${ARGV})
    target_include_directories(zephyr_interface INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/${arg})
  endforeach()
endfunction()
add_subdirectory(${MODULE}/zephyr module)
add_executable(user main.c)
target_link_libraries(user PRIVATE made)
"""


@pytest.mark.usefixtures("cmake")
def test_a_zephyr_module_compiles_with_what_it_calls_of_zephyr(made, tmp_path):
    skin, folder = made
    (tmp_path / "CMakeLists.txt").write_text(ZEPHYR)
    (tmp_path / "main.c").write_text(MAIN)
    run(["cmake", "-S", tmp_path, "-B", tmp_path / "built", f"-DMODULE={folder}",
         "-DCONFIG_INNERVATE_SKIN=y"])  # fmt: skip
    run(["cmake", "--build", tmp_path / "built"])
    assert run([tmp_path / "built/user"]).split() == ["7", "20000", skin.digest()]


@pytest.mark.parametrize(
    ("role", "sealed"),
    [("skin", False), ("mesh", False), ("radio", False), ("skin", True), ("mesh", True)],
)
def test_every_port_names_files_that_are_there(role, sealed, tmp_path):
    library.write(files_of(role, sealed), tmp_path)
    folder, own = tmp_path, {path.name for path in tmp_path.glob("*.c")}
    platformio = json.loads((folder / "library.json").read_text())
    assert platformio["name"] == f"innervate_{role}"
    assert re.fullmatch(r"\d+\.\d+\.\d+", platformio["version"])
    zephyr = (folder / "zephyr/CMakeLists.txt").read_text()
    assert {name[3:] for name in re.findall(r"\.\./\w+\.c", zephyr)} == own
    assert f"if(CONFIG_INNERVATE_{role.upper()})" in zephyr
    assert f"config INNERVATE_{role.upper()}" in (folder / "zephyr/Kconfig").read_text()
    module = dict(re.findall(r"^( *\w+):(.*)$", (folder / "zephyr/module.yml").read_text(), re.M))
    assert {name for name in module if not name.startswith(" ")} == MODULE
    assert {name.strip() for name in module if name.startswith(" ")} == BUILD
    assert (folder / module["  kconfig"].strip()).is_file()
    assert (folder / module["  cmake"].strip() / "CMakeLists.txt").is_file()
    cmake = (folder / "CMakeLists.txt").read_text()
    assert set(re.findall(r"\b\w+\.c\b", cmake)) == own
    assert set(re.findall(r"\b\w+\.h\b", cmake)) == {path.name for path in folder.glob("*.h")}
    lines = (folder / "library.properties").read_text().splitlines()
    properties = dict(line.split("=", 1) for line in lines)
    assert set(properties) >= ASKED
    assert all(properties.values())
    assert properties["category"] in ("Communication", "Other")
    assert properties["includes"] == f"{role}_node.h"
    left = [path for path in folder.rglob("*") if path.is_file()
            if "role" in path.name or "role_" in path.read_text()]  # fmt: skip
    assert left == []
