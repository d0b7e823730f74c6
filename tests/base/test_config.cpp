// SPDX-License-Identifier: BSD-3-Clause
#include "base/config.h"
#include "base/error.h"

#include <gmock/gmock.h>

namespace adit {
namespace {

struct Settings {
  bool on = true;
  int count = 3;
  double width_m = 3.7;
  std::string kind = "plan";
  std::vector<double> at{1, 2};
};

Fields fields(Settings& s) {
  Fields all{{"on", &s.on, ""}, {"count", &s.count, "", 1, 10}};
  append(all, "mine",
         {{"width_m", &s.width_m, "", 0.5, 20}, {"kind", &s.kind, "", {"plan", "panel"}}, {"at", &s.at, ""}});
  return all;
}

std::string error_of(const std::string& text) {
  Settings s;
  try {
    Document::parse("a.toml", text).read(fields(s));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Config, ReadsWhatItWrote) {
  Settings a;
  a.on = false;
  a.width_m = 0.1 + 0.7;
  a.kind = "panel";
  a.at = {-1e-9, 4};
  Settings b;
  Document::parse("a.toml", to_toml(fields(a))).read(fields(b));
  EXPECT_EQ(b.on, a.on);
  EXPECT_EQ(b.width_m, a.width_m);  // to the last bit
  EXPECT_EQ(b.kind, a.kind);
  EXPECT_EQ(b.at, a.at);
}

TEST(Config, AnErrorNamesFileLineKeyAndWhatIsRight) {
  EXPECT_EQ(error_of("on = true\n[mine]\nwidth_n = 2.0\n"),
            "a.toml:3: unknown key 'mine.width_n' (did you mean 'mine.width_m'?)");
  EXPECT_EQ(error_of("[mine]\nwidth_m = -1.0\n"), "a.toml:2: 'mine.width_m' is -1, must be 0.5 to 20");
  EXPECT_EQ(error_of("[mine]\nwidth_m = nan\n"), "a.toml:2: 'mine.width_m' is nan, must be finite");
  EXPECT_EQ(error_of("count = 1.5"), "a.toml:1: 'count' must be a whole number");
  EXPECT_EQ(error_of("on = 'yes'"), "a.toml:1: 'on' must be true or false");
  EXPECT_EQ(error_of("mine.kind = 'cave'"), "a.toml:1: 'mine.kind' is \"cave\", must be one of \"plan\", \"panel\"");
  EXPECT_THAT(error_of("[mine\n"), ::testing::StartsWith("a.toml:1: not TOML"));
  EXPECT_THAT(error_of("[[mine.hole]]\nx = 1\n"), ::testing::HasSubstr("unknown key 'mine.hole'"));
}

TEST(Config, SetTakesTheKeysOfTheFile) {
  Settings s;
  set_field(fields(s), "mine.width_m=2");
  set_field(fields(s), "mine.kind=panel");
  set_field(fields(s), "mine.at=[3, 4.5]");
  EXPECT_EQ(s.width_m, 2);
  EXPECT_EQ(s.kind, "panel");
  EXPECT_EQ(s.at, (std::vector<double>{3, 4.5}));
  EXPECT_THROW(set_field(fields(s), "mine.width_m"), Error);
  EXPECT_THROW(set_field(fields(s), "mine.width_m=99"), Error);
  EXPECT_THROW(set_field(fields(s), "mine.depth_m=9"), Error);
}

TEST(Config, TablesOfAnArrayAreDocumentsThatKnowTheirLines) {
  const Document d = Document::parse("rig.toml", "name = 'r'\n[[laser]]\nname = 'a'\n[[laser]]\nnam = 'b'\n");
  const std::vector<Document> lasers = d.tables("laser");
  ASSERT_EQ(lasers.size(), 2u);
  std::string name;
  lasers[0].read({{"name", &name, ""}});
  EXPECT_EQ(name, "a");
  try {
    lasers[1].read({{"name", &name, ""}});
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "rig.toml:5: unknown key 'nam' (did you mean 'name'?)");
  }
}

TEST(Config, AnUnknownBundledNameIsAnsweredWithThoseThereAre) {
  try {
    Document::find("sensors/lasers", "lms20");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("did you mean 'lms200'?"));
  }
}

TEST(Document, AListOfAnythingComesAsTextThatAFieldReads) {
  const Document d =
      Document::parse("x.toml", "v = [1, 2.0, \"a \\\"b\\\"\", true, [\"x\", \"y\"], []]\nn = 3\nt = [{a = 1}]\n");
  EXPECT_EQ(d.texts("v"), (std::vector<std::string>{"1", "2.0", "\"a \\\"b\\\"\"", "true", "[\"x\", \"y\"]", "[]"}));
  std::vector<std::string> words;
  set_field({{"w", &words, ""}}, "w=" + d.texts("v")[4]);
  EXPECT_EQ(words, (std::vector<std::string>{"x", "y"}));
  EXPECT_TRUE(d.texts("none").empty());
  EXPECT_THROW(d.texts("n"), Error);
  EXPECT_THROW(d.texts("t"), Error);
}

}  // namespace
}  // namespace adit
