#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the pictures of the HTML pages in docs/reports.md, docs/batch.md and docs/compare.md.

    pages.py SPHERETREE MAKE_MODELS BUNNY.obj

Builds what they show (about half a minute of a quiet machine: the pages show seconds) and takes the pictures with headless
Chromium into the folder of this script. Needs chromium, chromium-driver, python3-selenium and pngquant.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

from selenium import webdriver

HERE = pathlib.Path(__file__).resolve().parent
ARGUMENTS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage",
             "--enable-unsafe-swiftshader", "--hide-scrollbars")
COLOUR_BY_MAKER = """
    const colour = document.getElementById('colour');
    colour.value = 'maker';
    colour.dispatchEvent(new Event('change'));"""
TWO_FRAMES = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));"


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for argument in ARGUMENTS:
        options.add_argument(argument)
    service = webdriver.chrome.service.Service(shutil.which("chromedriver"))
    return webdriver.Chrome(service=service, options=options)


def shoot(driver, page, name, width, height, scheme="light", script=""):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                           {"media": "", "features": [{"name": "prefers-color-scheme", "value": scheme}]})
    driver.get(page.as_uri())
    driver.execute_async_script(TWO_FRAMES)
    driver.execute_script(script)
    driver.execute_async_script(TWO_FRAMES)
    shot = page.parent / name
    driver.save_screenshot(str(shot))
    subprocess.run(["pngquant", "--force", "--quality", "70-95", "--output", HERE / name, shot], check=True)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, make_models, bunny = (pathlib.Path(name).resolve() for name in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        run = lambda *words, codes=(0,): subprocess.run([*map(str, words)], cwd=work, stdout=subprocess.DEVNULL,
                                                        stderr=subprocess.DEVNULL).returncode in codes or sys.exit(f"{words} failed")
        run(make_models, "-o", "models")
        shutil.copy(bunny, work / "bunny-1500.obj")
        (work / "models" / "broken.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
        (work / "models" / "cloud.ply").write_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                                   "property float y\nproperty float z\nend_header\n0 0 0\n")
        run(program, "build", "bunny-1500.obj", "-o", "bunny.sph", "--report", "bunny.html")
        run(program, "compare", "models/gear.obj", "--qualities", "fast", "--report", "gear.html")
        run(program, "batch", "models", "-o", "trees", "--quality", "fast", "--levels", "3", "--pages", codes=(7,))
        driver = browser()
        try:
            shoot(driver, work / "bunny.html", "report-light.png", 960, 1170)
            shoot(driver, work / "bunny.html", "report-dark.png", 960, 720, "dark", COLOUR_BY_MAKER)
            shoot(driver, work / "gear.html", "compare.png", 1100, 1280)
            shoot(driver, work / "trees" / "summary.html", "batch.png", 1100, 900)
        finally:
            driver.quit()


if __name__ == "__main__":
    main()
