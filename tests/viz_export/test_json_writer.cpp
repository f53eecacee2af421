#include "viz_export/files/json_writer.h"

#include <cstdlib>
#include <limits>

#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("JSON numbers read back to the same bits and non-finite ones are null", "[viz_export][json]") {
  Random random(1, 0);
  for (int k = 0; k < 2000; ++k) {
    const double v = std::bit_cast<double>(random.bits());
    if (v != v || v - v != 0.0) continue;
    CHECK(std::strtod(json_number(v).c_str(), nullptr) == v);
  }
  CHECK(json_number(0.1) == "0.1");
  CHECK(json_number(std::numeric_limits<double>::quiet_NaN()) == "null");
  CHECK(json_number(-std::numeric_limits<double>::infinity()) == "null");
}

TEST_CASE("JSON text escapes quotes, control characters and bytes that are not UTF-8", "[viz_export][json]") {
  CHECK(json_text("a\"b\\c\n\t\x01") == R"("a\"b\\c\n\t\u0001")");
  CHECK(json_text("\u00b5 \u20ac \U0001f600") == "\"\u00b5 \u20ac \U0001f600\"");
  // overlong '/', a surrogate, beyond U+10FFFF, a cut sequence: one replacement character per byte (RFC 3629, section
  // 3)
  CHECK(json_text("\xc0\xaf") == "\"\ufffd\ufffd\"");
  CHECK(json_text("\xed\xa0\x80") == "\"\ufffd\ufffd\ufffd\"");
  CHECK(json_text("\xf4\x90\x80\x80") == "\"\ufffd\ufffd\ufffd\ufffd\"");
  CHECK(json_text("\xe2\x82") == "\"\ufffd\ufffd\"");
}

TEST_CASE("JSON objects and arrays nest with commas where they belong", "[viz_export][json]") {
  JsonWriter json;
  json.begin_object().member("a", 1).member("b", std::optional<double>()).key("c").begin_array();
  json.value(true).begin_object().end_object().value("x").end_array().member("d", std::optional<double>(2.5));
  json.member("e", std::uint64_t{18446744073709551615ull}).end_object();
  CHECK(json.text() ==
        "{\n  \"a\": 1,\n  \"c\": [\n    true,\n    {},\n    \"x\"\n  ],\n  \"d\": 2.5,\n"
        "  \"e\": 18446744073709551615\n}");
}
