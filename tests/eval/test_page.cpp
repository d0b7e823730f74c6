// SPDX-License-Identifier: BSD-3-Clause
// The page in a browser: headless Chromium, which draws its view in space by software.
#include "base/files.h"
#include "eval/report.h"
#include "tests/eval/synthetic_run.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace adit {
namespace {

namespace fs = std::filesystem;

// What a reader would do, done by a script that is put into a copy of the page; what it found stands in #said.
const char* driver = R"js(
(async () => {
  const said = {};
  const tell = (key, value) => { said[key] = value; };
  const list = document.createElement('pre');
  list.id = 'said';
  const say = () => { list.textContent = JSON.stringify(said); document.body.append(list); };
  const frames = (n) => new Promise((done) => { const next = () => (n-- > 0 ? requestAnimationFrame(next) : done()); next(); });
  const until = async (test) => { for (let k = 0; k < 400 && !test(); ++k) await new Promise((r) => setTimeout(r, 25)); return test(); };
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
  const change = async (act) => { const before = pixels(); await act(); await frames(1); return differing(before, pixels()); };
  try {
    tell('ready', await until(() => document.querySelector('.space[data-ready="yes"]')) !== null);
    await until(() => all('.chart .plot svg').length >= 6);
    tell('width', document.documentElement.clientWidth);
    tell('overflow', document.documentElement.scrollWidth - document.documentElement.clientWidth);
    tell('wide', all('body *').filter((e) => e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('.plate, .scroll, pre, .wide, table')).map((e) => e.tagName + '.' + e.className).slice(0, 5));
    tell('charts', all('.chart .plot svg').filter((s) => s.querySelector('.line, .bar') && s.getBoundingClientRect().width > 200).length);
    tell('hidden', all('#along-section[hidden], #view-section[hidden], #errors-section[hidden]').length);
    tell('unnamed', all('svg[role="img"]:not([aria-label]), img:not([alt]), canvas:not([aria-label])').length);
    say();
    if (window.innerWidth < 700) return;
    await frames(1);
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
    tell('keys turn', await change(() => canvas().dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }))));
    const heads = all('#passages-table th button'), column = heads.length - 1;
    const cells = () => all('#passages-table tbody tr').map((r) => Number(r.cells[column].dataset.v));
    heads[column].click();
    const down = cells();
    heads[column].click();
    tell('sorted', [down, cells()]);
    all('#passages-table tbody tr')[0].dispatchEvent(new PointerEvent('pointerover', { bubbles: true }));
    tell('passage shown', all('#plan .passage').every((p) => p.getAttribute('points').length > 5));
  } catch (error) {
    tell('error', String(error.stack));
  }
  say();
})();
)js";

// A picture of the view in space may take the browser some fifteen seconds of its own virtual time.
constexpr int budget_ms = 2000000;

struct Visit {
  std::string dom, log;
};

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
  static void TearDownTestSuite() { fs::remove_all(folder); }
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "chromium is not installed (ci/setup --peers)";
  }

  static Visit visit(const std::string& file, const std::string& flags) {
    const std::string home = folder + "/browser", dom = folder + "/dom.html", log = folder + "/log.txt";
    const std::string command =
        "timeout 240 chromium --headless --no-sandbox --disable-gpu --use-angle=swiftshader "
        "--enable-unsafe-swiftshader "
        "--hide-scrollbars --disable-dev-shm-usage --enable-logging=stderr --virtual-time-budget=" +
        std::to_string(budget_ms) + " --user-data-dir=" + home + " " + flags + " 'file://" + folder + "/" + file +
        "' >" + dom + " 2>" + log;
    const int code = std::system(command.c_str());
    const Visit seen{read_text(dom), read_text(log)};
    fs::remove_all(home);
    EXPECT_EQ(WEXITSTATUS(code), 0) << seen.log;
    return seen;
  }

  // The page with the driver in it, in a window of that width; what the driver said.
  static nlohmann::json drive(int width_px) {
    std::string html = read_text(folder + "/index.html");
    const size_t policy = html.find("<meta http-equiv=\"Content-Security-Policy\"");
    html.erase(policy, html.find('>', policy) + 1 - policy);  // it lets no script run but the page's
    html.insert(html.rfind("</body>"), std::string("<script>") + driver + "</script>");
    write_text(folder + "/driven.html", html);
    const Visit seen = visit("driven.html", "--dump-dom --window-size=" + std::to_string(width_px) + ",1000");
    const size_t from = seen.dom.find("<pre id=\"said\">"), to = seen.dom.find("</pre>", from);
    EXPECT_NE(from, std::string::npos) << seen.log;
    if (from == std::string::npos) return {};
    return nlohmann::json::parse(seen.dom.substr(from + 15, to - from - 15));
  }

  inline static std::string folder;
};

TEST_F(Page, UnderItsOwnPolicyItSaysNoErrorAndShowsAll) {
  const Visit seen = visit("index.html", "--dump-dom --window-size=1400,1000");
  for (const std::string bad : {"Uncaught", "Refused", "ERROR:CONSOLE", "Content Security Policy", "ResizeObserver"})
    EXPECT_EQ(seen.log.find(bad), std::string::npos) << seen.log;
  EXPECT_NE(seen.dom.find("data-ready=\"yes\""), std::string::npos);
  EXPECT_NE(seen.dom.find("class=\"line one\""), std::string::npos);
}

TEST_F(Page, ItsScriptDoesWhatAReaderAsks) {
  const nlohmann::json said = drive(1400);
  ASSERT_FALSE(said.contains("error")) << said["error"];
  EXPECT_TRUE(said["ready"]);
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

TEST_F(Page, NothingIsWiderThanATelephone) {
  const nlohmann::json said = drive(500);  // the narrowest window that the browser opens
  ASSERT_FALSE(said.contains("error")) << said["error"];
  EXPECT_LE(said["width"], 500);
  EXPECT_LE(said["overflow"], 0);
  EXPECT_GE(said["charts"], 6);
}

TEST_F(Page, ItPrints) {
  visit("index.html", "--no-pdf-header-footer --print-to-pdf=" + folder + "/page.pdf");
  const std::string pdf = read_text(folder + "/page.pdf");
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_GT(pdf.size(), 100000u);
}

}  // namespace
}  // namespace adit
