// softgrain schema: which keys a kind of scenes has, for people, for the guide and for editors.
#pragma once

#include <optional>
#include <string>

#include "common/core/enum_names.h"
#include "common/core/error.h"

namespace CLI {
class App;
}

namespace softgrain {

enum class SchemaForm { text, markdown, json };

template <>
inline constexpr auto enum_names<SchemaForm> = enum_name_list<SchemaForm>({{SchemaForm::text, "text"},
                                                                           {SchemaForm::markdown, "markdown"},
                                                                           {SchemaForm::json, "json"}});

struct SchemaOptions {
  bool chosen = false;
  std::string kind{};   ///< empty: the list of kinds
  std::string table{};  ///< "macro", "loading.stage", "." for the root; empty: the root and which tables there are
  SchemaForm form = SchemaForm::text;
};

/// Adds `schema` to the program's command line.
void add_schema_command(CLI::App& app, SchemaOptions& options);

/// Prints what was asked for. Throws InputError.
ExitStatus command_schema(const SchemaOptions& options);

}  // namespace softgrain
