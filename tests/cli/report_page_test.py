#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the HTML reports in headless Chromium and uses them as a reader would.

report_page_test.py PROGRAM WORK_FOLDER
Needs chromium, chromium-driver and python3-selenium.
"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
WORK = pathlib.Path(sys.argv[2]).resolve()
# A page is to be usable within 2 s. The machine may be busy with other things: one of so many loads has to be so fast.
MOST_SECONDS = 2
LOADS = 10
MOST_BYTES = 3_000_000


def torus(path, large=1.0, small=0.35, around=24, across=12):
    lines = []
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            ring = large + small * math.cos(v)
            lines.append(f"v {ring * math.cos(u)} {small * math.sin(v)} {-ring * math.sin(u)}")
    for i in range(around):
        for j in range(across):
            a = i * across + j
            b = (i + 1) % around * across + j
            c = (i + 1) % around * across + (j + 1) % across
            d = i * across + (j + 1) % across
            lines.append(f"f {a + 1} {b + 1} {c + 1} {d + 1}")
    path.write_text("\n".join(lines) + "\n")


def run(*arguments, codes=(0,)):
    done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=WORK, capture_output=True, text=True)
    assert done.returncode in codes, done.stderr
    return done.stdout


def browser():
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    # WebGL without a graphics card. Not forced upon the rest of the browser (--use-angle=swiftshader
    # --ignore-gpu-blocklist): that would draw the text of the page by emulated shaders too, several times slower.
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader",
                     "--window-size=1280,2200", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = webdriver.chrome.service.Service(shutil.which("chromedriver"))
    return webdriver.Chrome(service=service, options=options)


def luminance(rgb):
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in (v / 255 for v in rgb)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)
        torus(WORK / "torus.obj")
        torus(WORK / "ring & <more>.obj", small=0.2, around=16, across=6)
        (WORK / "broken.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
        run("build", "torus.obj", "-o", "torus.sph", "--branch", 4, "--levels", 4, "--quality", "fast",
            "--report", "torus.html", "--report", "torus.json")
        run("eval", "torus.obj", "torus.sph", "--report", "eval.html")
        cls.driver = browser()

    @classmethod
    def tearDownClass(cls):
        cls.driver.quit()

    # --- what a reader does ---

    def open(self, name, scheme="light"):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "media": "", "features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.driver.get((WORK / name).as_uri())
        self.driver.execute_async_script("""
            const done = arguments[0];
            const look = () => document.documentElement.dataset.interactiveMs ? done() : setTimeout(look, 10);
            look();""")
        self.settle()

    def settle(self):
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));")

    def at(self, name):
        return self.driver.find_element(By.ID, name)

    def picture(self):
        """The pixels of the 3D view, as text to compare."""
        self.settle()
        return self.driver.execute_script("return document.querySelector('#picture canvas').toDataURL()")

    def processor_seconds(self):
        """What the process of the page has used so far; a page that is opened anew may begin at 0 again."""
        metrics = self.driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
        return next(metric["value"] for metric in metrics if metric["name"] == "ProcessTime")

    def drawn(self):
        """How many pixels of the 3D view show something."""
        return self.driver.execute_script("""
            const source = document.querySelector('#picture canvas');
            const copy = document.createElement('canvas');
            [copy.width, copy.height] = [source.width, source.height];
            const context = copy.getContext('2d');
            context.drawImage(source, 0, 0);
            const pixels = context.getImageData(0, 0, copy.width, copy.height).data;
            let count = 0;
            for (let k = 3; k < pixels.length; k += 4) count += pixels[k] > 0 ? 1 : 0;
            return count;""")

    def colours(self):
        style = "return getComputedStyle(document.body)."
        return [tuple(int(n) for n in re.findall(r"\d+", self.driver.execute_script(style + key))[:3])
                for key in ("color", "backgroundColor")]

    def assert_sound(self):
        entries = self.driver.get_log("browser")
        self.assertEqual([e for e in entries if e["level"] == "SEVERE"], [])
        # Nothing came from anywhere, and nothing was even asked for.
        resources = self.driver.execute_script(
            "return performance.getEntriesByType('resource').map((entry) => entry.name)")
        self.assertEqual([name for name in resources if not name.startswith("data:")], [])
        # Whoever cannot see the page is told what each control is.
        self.assertEqual(self.driver.execute_script("""
            return [...document.querySelectorAll('input, select, button, canvas[role], [tabindex="0"]')]
              .filter((one) => !one.labels?.length && !one.getAttribute('aria-label') && !one.textContent.trim())
              .map((one) => one.outerHTML);"""), [])
        self.assertEqual(self.driver.execute_script("""
            const ids = [...document.querySelectorAll('body > :not(script) [id]')].map((one) => one.id)
              .filter((id) => id !== 'ball' || !document.querySelector('svg.thumbnail'));
            return ids.filter((id, k) => ids.indexOf(id) !== k);"""), [])

    # --- the page of a tree ---

    def test_opens_quickly_and_is_small(self):
        self.driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
        walls, spents = [], []
        for _ in range(LOADS):
            self.driver.get("about:blank")  # the page before is gone
            before = self.processor_seconds()
            self.open("torus.html")
            walls.append(int(self.driver.execute_script("return document.documentElement.dataset.interactiveMs")))
            spents.append(self.processor_seconds() - before)
            if len(walls) >= 3 and min(walls) < 1000 * MOST_SECONDS:
                break
        size = (WORK / "torus.html").stat().st_size
        print(f"interactive after {min(walls)} ms (of {walls}), {min(spents):.2f} s of processor time, {size / 1e6:.2f} MB")
        self.assertLess(min(walls), 1000 * MOST_SECONDS)
        self.assertLess(min(spents), MOST_SECONDS)
        self.assertLess(size, MOST_BYTES)
        self.assert_sound()
        text = (WORK / "torus.html").read_text()
        self.assertNotRegex(text, r"""(src|href)\s*=\s*["']?https?:""")

    def test_says_what_the_json_report_says(self):
        self.open("torus.html")
        report = json.loads((WORK / "torus.json").read_text())
        rows = self.driver.find_elements(By.CSS_SELECTOR, "#levels tbody tr")
        self.assertEqual(len(rows), len(report["levels"]))
        for row, level in zip(rows, report["levels"]):
            cells = [cell.text for cell in row.find_elements(By.CSS_SELECTOR, "th, td")]
            self.assertEqual(cells[:2], [str(level["level"]), str(level["spheres"])])
            worst = 100 * level["overhang_worst_relative"]["upper"]
            self.assertAlmostEqual(float(cells[2].split()[0]) / worst, 1, delta=0.01)
            for name, sets in level["winners"].items():
                self.assertIn(f"{name} {sets}", cells[-1])
        self.assertIn("certified", self.at("lead").text)
        self.assertIn(report["tree"]["content_hash"], self.at("proof").text)

    def test_levels_change_what_is_drawn(self):
        self.open("torus.html")
        slider = self.at("level")
        seen = {}
        for level in range(4):
            self.driver.execute_script("arguments[0].focus()", slider)
            slider.send_keys(Keys.HOME, *[Keys.ARROW_RIGHT] * level)
            seen[self.picture()] = level
            self.assertGreater(self.drawn(), 5000)
            current = self.driver.find_element(By.CSS_SELECTOR, "#levels tr.current th").text
            self.assertEqual(current, str(level))
        self.assertEqual(len(seen), 4)

    def test_hands_on_the_keyboard_only(self):
        self.open("torus.html")
        picture = self.at("picture")
        views = [self.picture()]
        for key in (Keys.ARROW_LEFT, Keys.ARROW_UP, "+", "1", "2"):
            self.driver.execute_script("arguments[0].focus()", picture)
            picture.send_keys(key)
            views.append(self.picture())
        self.assertEqual(len(set(views)), len(views))
        self.assertTrue(self.at("level-out").text.startswith("2:"))
        reached = set()
        body = self.driver.find_element(By.TAG_NAME, "body")
        body.send_keys(Keys.TAB)
        for _ in range(20):
            active = self.driver.switch_to.active_element
            reached.add(active.get_attribute("id"))
            active.send_keys(Keys.TAB)
        self.assertLessEqual({"picture", "level", "colour", "ball-opacity", "mesh-opacity", "worst", "next"}, reached)

    def test_flags_the_worst_ball_and_names_it(self):
        self.open("torus.html")
        report = json.loads((WORK / "torus.json").read_text())
        level = int(self.at("level").get_attribute("value"))
        worst = 100 * report["levels"][level]["overhang_worst_relative"]["upper"]
        shown = float(re.search(r"worst ([\d.]+)", self.at("flag").text).group(1))
        self.assertAlmostEqual(shown / worst, 1, delta=0.01)
        before = self.picture()
        self.at("worst").click()
        self.assertNotEqual(self.picture(), before)
        number = report["levels"][level]["worst_sphere"]
        self.assertIn("(worst)", self.at("ball").text)
        self.assertIn(f"Ball {number} of", self.at("ball").text)
        self.assertIn("set won by", self.at("ball").text)

    def test_shows_who_won_the_sets(self):
        self.open("torus.html")
        report = json.loads((WORK / "torus.json").read_text())
        self.driver.execute_script("""
            arguments[0].value = 'maker';
            arguments[0].dispatchEvent(new Event('change'));""", self.at("colour"))
        level = int(self.at("level").get_attribute("value"))
        for name in report["levels"][level]["winners"]:
            self.assertIn(name, self.at("legend").text)

    def test_a_click_picks_a_ball_where_there_is_one(self):
        self.open("torus.html")
        self.at("worst").click()  # turns it into the middle of the picture
        self.driver.execute_script("document.getElementById('next').click()")
        stepped = self.at("ball").text
        self.driver.execute_script("document.getElementById('worst').click()")
        self.settle()
        mouse = webdriver.ActionChains(self.driver)
        mouse.move_to_element_with_offset(self.at("picture"), 10 - self.at("picture").size["width"] // 2, 0).click().perform()
        self.assertIn("Click a ball", self.at("ball").text)  # there is nothing at the edge
        mouse.move_to_element(self.at("picture")).click().perform()
        self.assertRegex(self.at("ball").text, r"Ball \d+ of")
        self.assertNotEqual(self.at("ball").text, stepped)

    def test_can_be_read_in_the_dark_and_on_paper(self):
        seen = {}
        for scheme in ("light", "dark"):
            self.open("torus.html", scheme)
            text, page = self.colours()
            light, dark = sorted((luminance(text), luminance(page)), reverse=True)
            self.assertGreater((light + 0.05) / (dark + 0.05), 7, scheme)
            chart = self.driver.execute_script("return document.getElementById('spheres-chart').toDataURL()")
            seen[scheme] = (text, page, chart)
        for of_light, of_dark in zip(seen["light"], seen["dark"]):
            self.assertNotEqual(of_light, of_dark)
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "media": "print", "features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        self.assertEqual(self.colours()[1], (255, 255, 255))
        self.assertFalse(self.at("worst").is_displayed())
        self.assertTrue(self.at("levels").is_displayed())
        self.assert_sound()

    def test_eval_has_the_same_page(self):
        self.open("eval.html")
        self.assertGreater(self.drawn(), 5000)
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#levels tbody tr")), 4)
        self.assertIn("torus.sph", self.at("lead").text)
        self.assert_sound()

    # --- the pages of many ---

    def test_the_batch_page_sorts_filters_and_links(self):
        (WORK / "assets").mkdir()
        for name in ("torus.obj", "ring & <more>.obj", "broken.obj"):
            shutil.copy(WORK / name, WORK / "assets" / name)
        run("batch", "assets", "-o", "out", "--quality", "fast", "--levels", 3, "--pages", codes=(7,))
        self.open("out/summary.html")
        names = lambda: [row.find_element(By.TAG_NAME, "th").text for row in
                         self.driver.find_elements(By.CSS_SELECTOR, "#assets tbody tr") if row.is_displayed()]
        self.assertEqual(len(names()), 3)
        for width in (700, 900, 1100, 1400):
            self.driver.set_window_size(width, 1000)
            self.settle()
            self.assertEqual(self.driver.execute_script(
                "return [...document.querySelectorAll('.scroll')].map((one) => Math.max(one.scrollWidth - one.clientWidth, 0))"),
                [0, 0], f"cut at {width} pixels")
        self.driver.find_element(By.XPATH, "//table[@id='assets']//button[text()='triangles']").click()
        rising = [name for name in names() if "broken" not in name]
        self.assertIn("more", rising[0])
        self.driver.find_element(By.XPATH, "//table[@id='assets']//button[text()='triangles']").click()
        self.assertEqual([name for name in names() if "broken" not in name], rising[::-1])
        self.assertIn("broken", names()[-1])  # what has no figure stands last either way
        self.at("filter").send_keys("broken")
        self.assertEqual(len(names()), 1)
        self.at("filter").send_keys(Keys.BACKSPACE * 6)
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "#assets svg.thumbnail circle")) > 8, True)
        self.assert_sound()
        self.driver.find_element(By.PARTIAL_LINK_TEXT, "more").click()
        self.settle()
        self.assertIn("ring & <more>.obj", self.at("title").text)

    def test_the_comparison_page_marks_what_none_beats(self):
        run("compare", "torus.obj", "--builders", "octree,combined", "--qualities", "fast", "--report", "compare.html",
            "--report", "compare.json")
        self.open("compare.html")
        comparison = json.loads((WORK / "compare.json").read_text())
        rows = self.driver.find_elements(By.CSS_SELECTOR, "#rows tbody tr")
        self.assertEqual(len(rows), len(comparison["rows"]))
        for row, entry in zip(rows, comparison["rows"]):
            self.assertEqual("★" in row.text, entry["non_dominated"])
        self.assert_sound()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
