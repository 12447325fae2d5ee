#include "microsim/particles/scene_bodies.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

/// Longer lines hold no four numbers.
constexpr std::size_t kLongestLine = 4096;

/// Lines of a file one by one, so that files of any size need little memory; zlib passes plain files through.
class LineReader {
 public:
  explicit LineReader(const std::string& path) : path_(path), file_(nullptr, gzclose) {
    require_readable_file(path);
    file_.reset(gzopen(path.c_str(), "rb"));
    if (!file_) throw IoError(path + ": cannot be read");
    gzbuffer(file_.get(), 1U << 17U);
  }

  /// The next line without its end, good until the next call; false at the end of the file.
  bool next(std::string_view& line) {
    if (gzgets(file_.get(), buffer_.data(), static_cast<int>(buffer_.size())) == nullptr) {
      require_valid();
      return false;
    }
    ++number_;
    line = buffer_.data();
    if (line.ends_with('\n'))
      line.remove_suffix(1);
    else
      require_valid();  // the last line, or the place where a damaged file breaks off
    if (line.size() + 2 >= kLongestLine)
      wrong("the line is longer than " + std::to_string(kLongestLine) + " characters");
    return true;
  }

  [[noreturn]] void wrong(const std::string& problem) const {
    throw InputError(path_ + ":" + std::to_string(std::max<std::int64_t>(number_, 1)) + ": " + problem);
  }

 private:
  void require_valid() {
    int status = Z_OK;
    const std::string why = gzerror(file_.get(), &status);
    if (status != Z_OK && status != Z_STREAM_END) throw IoError(path_ + ": damaged or cut short (" + why + ")");
  }

  std::string path_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  std::array<char, kLongestLine> buffer_{};
  std::int64_t number_ = 0;
};

/// Four numbers separated by blanks or tabs, all finite, and nothing else.
std::array<double, 4> four_numbers(std::string_view line, const LineReader& reader, const char* what) {
  constexpr std::string_view kBlank = " \t\r";
  std::array<double, 4> out{};
  for (double& value : out) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    if (line.starts_with('+') && !line.starts_with("+-")) line.remove_prefix(1);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
      reader.wrong("must be four finite numbers, " + std::string(what));
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && kBlank.find(line.front()) == std::string_view::npos)
      reader.wrong("must be four numbers with blanks or tabs between them, " + std::string(what));
  }
  if (line.find_first_not_of(kBlank) != std::string_view::npos)
    reader.wrong("must be four numbers, " + std::string(what));
  return out;
}

std::int64_t count_of(double n, const LineReader& reader) {
  if (!(n >= 1.0) || n > 1e8 || n != std::floor(n)) reader.wrong("N must be a whole number from 1 to 1e8");
  return static_cast<std::int64_t>(n);
}

void require_end(LineReader& reader, std::int64_t n) {
  std::string_view line;
  while (reader.next(line))
    if (line.find_first_not_of(" \t\r") != std::string_view::npos)
      reader.wrong("more lines than the " + std::to_string(n) + " spheres of the first line");
}

}  // namespace

XyzrFile read_xyzr(const std::string& path, const std::function<void(std::int64_t)>& admit) {
  LineReader reader(path);
  std::string_view line;
  if (!reader.next(line)) reader.wrong("must be four finite numbers, N Lx Ly Lz");
  const auto head = four_numbers(line, reader, "N Lx Ly Lz");
  XyzrFile file;
  file.box = {{head[1], head[2], head[3]}};
  const std::int64_t n = count_of(head[0], reader);
  if (admit) admit(n);
  for (std::int64_t k = 0; k < n; ++k) {
    if (!reader.next(line))
      throw InputError(path + ":" + std::to_string(xyzr_line(static_cast<std::size_t>(k))) + ": the file ends after " +
                       std::to_string(k) + " of " + std::to_string(n) + " spheres");
    const auto v = four_numbers(line, reader, "x y z r");
    if (!(v[3] > 0.0)) reader.wrong("r = " + std::to_string(v[3]) + ": must be above 0");
    file.position.push_back({{v[0], v[1], v[2]}});
    file.radius.push_back(v[3]);
  }
  require_end(reader, n);
  return file;
}

}  // namespace softgrain
