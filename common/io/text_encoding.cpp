#include "common/io/text_file.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace softgrain {

namespace {

constexpr char32_t kReplacement = 0xfffd;

std::uint8_t byte_at(const std::string& text, std::size_t at) { return static_cast<std::uint8_t>(text[at]); }

/// Length of the UTF-8 character at `at`; 0 when there is none (wrong, overlong or cut short).
std::size_t character_length(const std::string& text, std::size_t at) {
  const std::uint8_t first = byte_at(text, at);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte_at(text, at + k) & 0xc0U) != 0x80) return 0;
  const std::uint8_t second = byte_at(text, at + 1);
  const bool wrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
                     (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f);
  return wrong ? 0 : length;
}

void append_utf8(std::string& out, char32_t c) {
  const auto put = [&](char32_t x) { out += static_cast<char>(static_cast<unsigned char>(x)); };
  if (c < 0x80) return put(c);
  if (c < 0x800) {
    put(0xc0U | c >> 6U);
  } else if (c < 0x10000) {
    put(0xe0U | c >> 12U);
    put(0x80U | (c >> 6U & 0x3fU));
  } else {
    put(0xf0U | c >> 18U);
    put(0x80U | (c >> 12U & 0x3fU));
    put(0x80U | (c >> 6U & 0x3fU));
  }
  put(0x80U | (c & 0x3fU));
}

std::string from_utf16(const std::string& bytes, std::size_t begin, bool low_first) {
  std::string out;
  const auto unit = [&](std::size_t at) {
    const char32_t a = byte_at(bytes, at);
    const char32_t b = byte_at(bytes, at + 1);
    return low_first ? b << 8U | a : a << 8U | b;
  };
  for (std::size_t at = begin; at + 1 < bytes.size(); at += 2) {
    char32_t c = unit(at);
    if (c >= 0xd800 && c < 0xdc00 && at + 3 < bytes.size()) {
      const char32_t second = unit(at + 2);
      if (second >= 0xdc00 && second < 0xe000) {
        c = 0x10000 + ((c - 0xd800) << 10U) + (second - 0xdc00);
        at += 2;
      }
    }
    append_utf8(out, c >= 0xd800 && c < 0xe000 ? kReplacement : c);
  }
  return out;
}

std::string from_windows(const std::string& bytes) {
  constexpr std::array<char32_t, 32> kHigh{0x20ac, 0x81,   0x201a, 0x192,  0x201e, 0x2026, 0x2020, 0x2021,
                                           0x2c6,  0x2030, 0x160,  0x2039, 0x152,  0x8d,   0x17d,  0x8f,
                                           0x90,   0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                           0x2dc,  0x2122, 0x161,  0x203a, 0x153,  0x9d,   0x17e,  0x178};
  std::string out;
  for (const char b : bytes) {
    const auto c = static_cast<std::uint8_t>(b);
    append_utf8(out, c >= 0x80 && c < 0xa0 ? kHigh[c - 0x80U] : c);
  }
  return out;
}

/// Share of zero bytes at even (0) or odd (1) places of the beginning.
double zeros_at(const std::string& bytes, std::size_t parity) {
  const std::size_t end = std::min<std::size_t>(bytes.size(), 4096);
  double zeros = 0.0;
  double all = 0.0;
  for (std::size_t at = parity; at < end; at += 2) {
    zeros += bytes[at] == '\0' ? 1.0 : 0.0;
    all += 1.0;
  }
  return all > 0.0 ? zeros / all : 0.0;
}

}  // namespace

bool is_utf8(const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t length = character_length(bytes, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
}

std::string utf8_of(const std::string& bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) return utf8_of(bytes.substr(3));
  if (bytes.starts_with("\xff\xfe")) return from_utf16(bytes, 2, true);
  if (bytes.starts_with("\xfe\xff")) return from_utf16(bytes, 2, false);
  constexpr double kMost = 0.6;  // of a text in Latin letters nearly all high bytes are zero
  constexpr double kFew = 0.05;
  const double even = zeros_at(bytes, 0);
  const double odd = zeros_at(bytes, 1);
  if (bytes.size() >= 4 && odd > kMost && even < kFew) return from_utf16(bytes, 0, true);
  if (bytes.size() >= 4 && even > kMost && odd < kFew) return from_utf16(bytes, 0, false);
  return is_utf8(bytes) ? bytes : from_windows(bytes);
}

std::string replaced_utf8(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    if (length == 0)
      append_utf8(out, kReplacement);
    else
      out.append(text, at, length);
    at += std::max<std::size_t>(length, 1);
  }
  return out;
}

}  // namespace softgrain
