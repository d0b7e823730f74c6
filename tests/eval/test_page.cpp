// SPDX-License-Identifier: BSD-3-Clause
// The page in a browser.
#include "base/error.h"
#include "eval/report.h"
#include "tests/eval/browser.h"
#include "tests/eval/synthetic_run.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>

namespace adit {
namespace {

// What a reader would do; the value is what it found.
const char* reader = R"js(
(async () => {
  const said = {};
  const tell = (key, value) => { said[key] = value; };
  const frames = (n) => new Promise((done) => { const next = () => (n-- > 0 ? requestAnimationFrame(next) : done()); next(); });
  const until = async (test) => { while (!test()) await frames(1); return test(); };
  const all = (what) => [...document.querySelectorAll(what)];
  const canvas = () => document.querySelector('.space canvas');
  const pixels = () => {
    const copy = document.createElement('canvas');
    copy.width = canvas().width, copy.height = canvas().height;
    const context = copy.getContext('2d');
    context.drawImage(canvas(), 0, 0);
    return context.getImageData(0, 0, copy.width, copy.height).data;
  };
  const differing = (a, b) => {
    let n = 0;
    for (let k = 0; k < a.length; k += 4) n += a[k] !== b[k] || a[k + 1] !== b[k + 1] || a[k + 2] !== b[k + 2] || a[k + 3] !== b[k + 3];
    return n;
  };
  const change = async (act) => {
    const before = pixels();
    act();
    let n = 0;
    for (let k = 0; k < 100 && n === 0; ++k) await frames(1), n = differing(before, pixels());
    return n;
  };
  tell('ready', await until(() => document.querySelector('.space[data-ready="yes"]')) !== null);
  await until(() => all('.chart .plot svg').length >= 6);
  tell('width', document.documentElement.clientWidth);
  tell('overflow', document.documentElement.scrollWidth - document.documentElement.clientWidth);
  tell('charts', all('.chart .plot svg').filter((s) => s.querySelector('.line, .bar') && s.getBoundingClientRect().width > 200).length);
  tell('lines', all('.line.one').length);
  tell('hidden', all('#along-section[hidden], #view-section[hidden], #errors-section[hidden]').length);
  tell('unnamed', all('svg[role="img"]:not([aria-label]), img:not([alt]), canvas:not([aria-label])').length);
  await frames(2);
  const first = pixels();
  let drawn = 0;
  const inks = new Set();
  for (let k = 0; k < first.length; k += 4) if (first[k + 3] > 0) { ++drawn; inks.add(first[k] << 16 | first[k + 1] << 8 | first[k + 2]); }
  tell('drawn_share', drawn / (first.length / 4));
  tell('inks', inks.size);
  for (const box of all('.toggles input'))
    tell('toggle ' + box.id, [await change(() => box.click()), await change(() => box.click())]);
  const data = JSON.parse(document.getElementById('data').textContent), slider = document.getElementById('place');
  const marks = () => all('#plan .place').map((m) => m.getAttribute('transform'));
  const k = Math.floor(data.path.along.length / 3);
  const rule = () => Number(document.querySelector('.rule').getAttribute('x1'));
  const place_before = rule();
  tell('beams and mark follow', await change(() => { slider.value = k; slider.dispatchEvent(new Event('input')); }));
  tell('rule moved', Math.abs(rule() - place_before));
  tell('marks', marks());
  tell('expected', ['wide', 'narrow'].map((kind) => [data.plan[kind].x + data.plan[kind].px_per_m * data.path.x[k], data.plan[kind].y - data.plan[kind].px_per_m * data.path.y[k]]));
  const chart = document.querySelector('.follows'), box = chart.getBoundingClientRect(), was = slider.value;
  chart.dispatchEvent(new PointerEvent('pointerdown', { clientX: box.left + 0.8 * box.width, clientY: box.top + 20, bubbles: true }));
  tell('pointer moved the slider', Number(slider.value) - Number(was));
  await frames(2);  // the beams go along
  tell('keys turn', await change(() => canvas().dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }))));
  const heads = all('#passages-table th button'), column = heads.length - 1;
  const cells = () => all('#passages-table tbody tr').map((r) => Number(r.cells[column].dataset.v));
  heads[column].click();
  const down = cells();
  heads[column].click();
  tell('sorted', [down, cells()]);
  all('#passages-table tbody tr')[0].dispatchEvent(new PointerEvent('pointerover', { bubbles: true }));
  tell('passage shown', all('#plan .passage').every((p) => p.getAttribute('points').length > 5));
  return said;
})()
)js";

class Page : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = scratch("page");
    ReportSettings settings;
    settings.width_px = 600;
    settings.interiors = settings.places = settings.frames = 1;
    static SyntheticRun run = synthetic_run(0.4, 1.0);
    run.score.passages.push_back({0, 400, 0.02, 0.05, 0.2});
    write_report(folder, run.input(), settings);
  }
  void SetUp() override {
    if (!Browser::installed()) GTEST_SKIP() << "chromium is not installed (ci/setup --peers)";
  }

  static std::string url() { return "file://" + folder + "/index.html"; }

  inline static std::string folder;
};

TEST_F(Page, ItsScriptDoesWhatAReaderAsks) {
  Browser browser(1400, 1000);
  browser.open(url());
  const auto said = nlohmann::json::parse(browser.run(reader));
  // Under its own security policy, which lets nothing in that the page does not hold.
  EXPECT_THAT(browser.errors(), ::testing::IsEmpty());
  EXPECT_TRUE(said["ready"]);
  EXPECT_GE(said["lines"], 1);
  EXPECT_EQ(said["hidden"], 0);
  EXPECT_EQ(said["unnamed"], 0);
  EXPECT_LE(said["overflow"], 0);
  // Position, heading, three histograms (floor, roof, ribs) and the error against distance.
  EXPECT_GE(said["charts"], 6);
  // A ring of 44 m seen whole covers some tenth of the view, in more colours than any flat fill has.
  EXPECT_GT(said["drawn_share"], 0.02);
  EXPECT_GT(said["inks"], 100);
  for (const std::string name : {"map", "true-mine", "roof", "mapped-path", "true-path", "lasers"}) {
    const auto& changed = said["toggle show-" + name];
    ASSERT_TRUE(changed.is_array()) << name;
    EXPECT_GT(changed[0], 20) << name;
    EXPECT_GT(changed[1], 20) << name;
  }
  EXPECT_GT(said["beams and mark follow"], 20);
  EXPECT_GT(said["rule moved"], 100);
  EXPECT_GT(said["pointer moved the slider"], 10);
  EXPECT_GT(said["keys turn"], 1000);
  ASSERT_EQ(said["marks"].size(), 2u);
  for (int k = 0; k < 2; ++k) {
    double x = 0, y = 0;
    ASSERT_EQ(std::sscanf(said["marks"][k].get<std::string>().c_str(), "translate(%lf %lf)", &x, &y), 2);
    EXPECT_NEAR(x, said["expected"][k][0], 1e-6);
    EXPECT_NEAR(y, said["expected"][k][1], 1e-6);
  }
  const auto first = said["sorted"][0].get<std::vector<double>>(),
             second = said["sorted"][1].get<std::vector<double>>();
  EXPECT_NE(std::is_sorted(first.begin(), first.end()), std::is_sorted(second.begin(), second.end()));
  EXPECT_TRUE(said["passage shown"]);
}

TEST_F(Page, ATelephoneShowsItAllWithoutScrollingSideways) {
  Browser browser(400, 800);
  browser.open(url());
  const auto said = nlohmann::json::parse(browser.run(reader));
  EXPECT_THAT(browser.errors(), ::testing::IsEmpty());
  EXPECT_EQ(said["width"], 400);
  EXPECT_LE(said["overflow"], 0);
  EXPECT_GE(said["charts"], 6);
  EXPECT_GT(said["drawn_share"], 0.02);
  EXPECT_GT(said["pointer moved the slider"], 10);
}

TEST_F(Page, WhatItMayNotDoIsHeard) {
  Browser browser(1400, 1000);
  browser.open(url());
  browser.run("new Image().src = 'https://example.org/a.png'; new Promise((done) => setTimeout(done, 100))");
  ASSERT_FALSE(browser.errors().empty());
  EXPECT_NE(browser.errors()[0].find("Content Security Policy"), std::string::npos) << browser.errors()[0];
  EXPECT_THROW(browser.run("nothing.like.this"), Error);
}

TEST_F(Page, ItPrints) {
  Browser browser(1400, 1000);
  browser.open(url());
  const std::string pdf = browser.pdf();
  EXPECT_EQ(pdf.substr(0, 6), "JVBERi");  // "%PDF-" in base64
  EXPECT_GT(pdf.size(), 130000u);
}

}  // namespace
}  // namespace adit
