#include "common/io/key_record.h"

#include <stdexcept>

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
  AskedKey& known = keys_[scene][path];
  known.given = known.given || asked.given;
  if (asked.form == KeyForm::any) return;
  const bool given = known.given;
  known = asked;
  known.given = given;
}

void SceneTable::Impl::note_asked(const std::string& key, AskedKey asked) const {
  KeyRecord* const record = KeyRecord::current();
  if (record == nullptr) return;
  asked.given = content != nullptr && content->contains(key);
  const std::string own = path.empty() ? key : path + "." + key;
  record->note(document->name, own, asked);
  if (!document->variant.empty()) record->note(document->name, document->variant + "." + own, asked);
}

}  // namespace softgrain
