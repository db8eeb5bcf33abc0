// SPDX-License-Identifier: Apache-2.0
#include "hypertexture_geom/params/problems.h"

namespace morsel::params {
namespace {

using nlohmann::json;

class Collector {
 public:
  explicit Collector(const KindLookup& kinds) : kinds_(kinds) {}

  void object(const json& value, const Declaration& declaration, const Place& place) {
    if (!value.is_object()) {
      attempt([&] { JsonReader(value, declaration, place); });
      return;
    }
    for (const auto& item : value.items())
      if (!declares(declaration, item.key()))
        attempt([&] { JsonReader({{item.key(), item.value()}}, declaration, place); });
    for (const Parameter& p : declaration.parameters) parameter(value, declaration, p, place);
  }

  std::vector<std::string> take() { return std::move(problems_); }

 private:
  template <class Read>
  bool attempt(Read&& read) {
    try {
      read();
      return true;
    } catch (const InputError& e) {
      problems_.push_back(e.what());
      return false;
    }
  }

  static bool declares(const Declaration& declaration, const std::string& name) {
    for (const Parameter& p : declaration.parameters)
      if (p.name == name) return true;
    return false;
  }

  // Reads the object as if it had this parameter alone, and the one that decides if it applies.
  void parameter(const json& value, const Declaration& declaration, const Parameter& p,
                 const Place& place) {
    Declaration alone{declaration.name, declaration.help, {p}};
    json part = json::object();
    if (value.contains(p.name)) part[p.name] = value[p.name];
    for (const Parameter& other : declaration.parameters) {
      if (other.name != p.only_with) continue;
      Parameter any = other;  // what is wrong with it is said elsewhere
      any.optional = true;
      alone.parameters.push_back(any);
      const auto found = value.find(other.name);
      if (found != value.end() && found->is_string()) {
        alone.parameters.back().choices.push_back(found->get<std::string>());
        part[other.name] = *found;
      }
    }
    if (!attempt([&] { JsonReader(part, alone, place); }) || !part.contains(p.name)) return;
    if (p.type == Type::kObject) nested(part[p.name], p, place / p.name);
    if (p.type != Type::kArray) return;
    for (std::size_t i = 0; i < part[p.name].size(); ++i)
      nested(part[p.name][i], p, place / p.name / i);
  }

  void nested(const json& value, const Parameter& p, const Place& place) {
    if (p.record != nullptr) {
      object(value, *p.record, place);
    } else if (!p.kind.empty()) {
      const std::vector<TypedDeclaration> known = kinds_(p.kind);
      std::vector<std::string> types;
      types.reserve(known.size());
      for (const TypedDeclaration& k : known) types.push_back(k.type);
      std::string type;
      if (!attempt([&] { type = type_of(value, types, place); })) return;
      for (const TypedDeclaration& k : known)
        if (k.type == type) object(value, *k.declaration, place);
    }
  }

  const KindLookup& kinds_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> problems_of(const json& object, const Declaration& declaration,
                                     const Place& place, const KindLookup& kinds) {
  Collector collector(kinds);
  collector.object(object, declaration, place);
  return collector.take();
}

}  // namespace morsel::params
