#include "common/io/key_record.h"

#include <stdexcept>
#include <utility>

#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

thread_local KeyRecord* g_record = nullptr;

}  // namespace

KeyRecord::KeyRecord() {
  if (g_record != nullptr) throw std::logic_error("keys are taken down already");
  g_record = this;
}

KeyRecord::~KeyRecord() { g_record = nullptr; }

KeyRecord* KeyRecord::current() { return g_record; }

void KeyRecord::note(const std::string& scene, const std::string& path, const AskedKey& asked) {
  const auto [at, fresh] = keys_[scene].try_emplace(path);
  if (fresh) orders_[scene].push_back(path);
  AskedKey& known = at->second;
  known.given = known.given || asked.given;
  if (asked.form == KeyForm::any) return;
  if (!known.meaning.empty() && asked.meaning.empty()) return;  // asked again: the first time says all
  const bool given = std::exchange(known, asked).given;
  known.given = given;
}

void SceneTable::Impl::note_asked(const Key& key, AskedKey asked) const {
  KeyRecord* const record = KeyRecord::current();
  if (record == nullptr) return;
  asked.given = content != nullptr && content->contains(key.name);
  asked.meaning = key.meaning;
  asked.usual = key.usual;
  asked.retired = key.retired;
  const std::string own = path.empty() ? key.name : path + "." + key.name;
  record->note(document->name, own, asked);
  if (!document->variant.empty()) record->note(document->name, document->variant + "." + own, asked);
}

}  // namespace softgrain
