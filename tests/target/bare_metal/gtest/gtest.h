#pragma once

/// The part of GoogleTest that the project's unit tests use, for boards without files, streams and
/// exceptions: the same test sources run there unchanged. Results go to the port's text output.

#include <array>
#include <cstdint>
#include <type_traits>

namespace testing {

class Test {
 public:
  virtual ~Test() = default;
  virtual void SetUp() {}
  virtual void TearDown() {}
  static void SetUpTestSuite() {}
  static void TearDownTestSuite() {}
  static bool HasFatalFailure();
  static void RecordProperty(const char* key, int value);
};

template <class Parameter>
class TestWithParam : public Test {
 public:
  using ParamType = Parameter;
  static const Parameter& GetParam() { return *current_parameter; }
  static inline const Parameter* current_parameter = nullptr;
};

template <class... Each>
struct Types {};

template <class First, class... Rest>
std::array<First, 1 + sizeof...(Rest)> Values(const First& first, const Rest&... rest) {
  return {{first, rest...}};
}

namespace internal {

void print(const char* text);
void print(bool value);
void print(double value);
void print(std::int64_t value);
void print(std::uint64_t value);

template <class Value>
void print_any(const Value& value) {
  if constexpr (std::is_convertible_v<Value, const char*>) {
    print(static_cast<const char*>(value));
  } else if constexpr (std::is_same_v<Value, bool>) {
    print(value);
  } else if constexpr (std::is_floating_point_v<Value>) {
    print(static_cast<double>(value));
  } else if constexpr (std::is_enum_v<Value> || std::is_signed_v<Value>) {
    print(static_cast<std::int64_t>(value));
  } else if constexpr (std::is_unsigned_v<Value>) {
    print(static_cast<std::uint64_t>(value));
  } else {
    print("(object)");
  }
}

/// One test in the list of all.
struct Case {
  const char* suite = nullptr;
  const char* name = nullptr;
  void (*run)() = nullptr;
  void (*set_up_suite)() = nullptr;  ///< the same for all tests of a suite
  void (*tear_down_suite)() = nullptr;
  Case* next = nullptr;
};

/// Puts `test`, filled from `filling`, in front of the list.
bool add(Case& test, const Case& filling);
void note_failure(const char* file, int line, const char* text, bool fatal);

class Failure {
 public:
  Failure(const char* file, int line, const char* text, bool fatal) {
    note_failure(file, line, text, fatal);
  }
  Failure(const Failure&) = delete;
  Failure& operator=(const Failure&) = delete;
  ~Failure() { print("\n"); }
  template <class Value>
  const Failure& operator<<(const Value& value) const {
    print(" ");
    print_any(value);
    return *this;
  }
};

/// Makes `return Void{} & failure` an expression without value.
struct Void {
  void operator&(const Failure&) const {}
};

template <class A, class B>
bool show(bool good, const A& a, const B& b) {
  if (good) return true;
  print("  ");
  print_any(a);
  print(" and ");
  print_any(b);
  print("\n");
  return false;
}

template <class A, class B, class Difference>
bool near(const A& a, const B& b, const Difference& difference) {
  const auto d = a < b ? b - a : a - b;
  return show(d <= difference, a, b);
}

/// Equal, or at most four units in the last place apart.
template <class Value>
bool almost_equal(Value a, Value b) {
  const Value magnitude = (a < 0 ? -a : a) + (b < 0 ? -b : b);
  const Value unit =
      std::is_same_v<Value, float> ? Value(1.1920929e-7) : Value(2.220446049250313e-16);
  return a == b || near(a, b, 2 * unit * magnitude);
}

template <class Body>
void run_body() {
  Body test;
  static_cast<Test&>(test).SetUp();
  test.TestBody();
  static_cast<Test&>(test).TearDown();
}

template <class Body>
struct Registered {
  static inline Case test;
};

template <class Body>
bool add_body(const char* suite, const char* name) {
  return add(Registered<Body>::test, {suite, name, &run_body<Body>, &Body::SetUpTestSuite,
                                      &Body::TearDownTestSuite, nullptr});
}

template <template <class> class Body, class... Each>
bool add_typed(Types<Each...>, const char* suite, const char* name) {
  return (add_body<Body<Each>>(suite, name) && ...);
}

/// The list of an instantiation; a function that names its cases may follow and is not used.
template <class List, class... Namer>
List values_of(const List& list, const Namer&...) {
  return list;
}

/// Tests and parameters of one parameterised suite, joined when the tests run.
template <class Suite>
struct Parameterised {
  struct Body {
    const char* name;
    void (*run)();
    Body* next;
  };
  struct List {
    const typename Suite::ParamType* values;
    int count;
    List* next;
  };
  static inline Body* bodies = nullptr;
  static inline List* lists = nullptr;
  static inline Case test;

  static void run_all() {
    for (const List* list = lists; list != nullptr; list = list->next) {
      for (int i = 0; i < list->count; ++i) {
        Suite::current_parameter = list->values + i;
        for (const Body* body = bodies; body != nullptr; body = body->next) body->run();
      }
    }
  }
  template <class Test>
  static bool add_body(Body& body, const char* suite) {
    if (bodies == nullptr) {
      add(test, {suite, "*", &run_all, &Test::SetUpTestSuite, &Test::TearDownTestSuite, nullptr});
    }
    body.next = bodies;
    bodies = &body;
    return true;
  }
  static bool add_list(List& list) {
    list.next = lists;
    lists = &list;
    return true;
  }
};

}  // namespace internal
}  // namespace testing

#define CAIRN_TEST_CLASS(suite, name) suite##_##name##_Test

#define CAIRN_TEST_BODY(suite, name, parent)                                       \
  class CAIRN_TEST_CLASS(suite, name) : public parent {                            \
   public:                                                                         \
    using parent::SetUpTestSuite;                                                  \
    using parent::TearDownTestSuite;                                               \
    void TestBody();                                                               \
  };                                                                               \
  static const bool suite##_##name##_added =                                       \
      ::testing::internal::add_body<CAIRN_TEST_CLASS(suite, name)>(#suite, #name); \
  void CAIRN_TEST_CLASS(suite, name)::TestBody()

#define TEST(suite, name) CAIRN_TEST_BODY(suite, name, ::testing::Test)
#define TEST_F(suite, name) CAIRN_TEST_BODY(suite, name, suite)

#define TYPED_TEST_SUITE(suite, list, ...) using suite##_types = list
#define TYPED_TEST(suite, name)                                                              \
  template <class Parameter>                                                                 \
  class CAIRN_TEST_CLASS(suite, name) : public suite<Parameter> {                            \
   public:                                                                                   \
    using TestFixture = suite<Parameter>;                                                    \
    using TypeParam = Parameter;                                                             \
    using TestFixture::SetUpTestSuite;                                                       \
    using TestFixture::TearDownTestSuite;                                                    \
    void TestBody();                                                                         \
  };                                                                                         \
  static const bool suite##_##name##_added =                                                 \
      ::testing::internal::add_typed<CAIRN_TEST_CLASS(suite, name)>(suite##_types{}, #suite, \
                                                                    #name);                  \
  template <class Parameter>                                                                 \
  void CAIRN_TEST_CLASS(suite, name)<Parameter>::TestBody()

#define TEST_P(suite, name)                                                               \
  class CAIRN_TEST_CLASS(suite, name) : public suite {                                    \
   public:                                                                                \
    using suite::SetUpTestSuite;                                                          \
    using suite::TearDownTestSuite;                                                       \
    void TestBody();                                                                      \
  };                                                                                      \
  static ::testing::internal::Parameterised<suite>::Body suite##_##name##_body{           \
      #name, &::testing::internal::run_body<CAIRN_TEST_CLASS(suite, name)>, nullptr};     \
  static const bool suite##_##name##_added =                                              \
      ::testing::internal::Parameterised<suite>::add_body<CAIRN_TEST_CLASS(suite, name)>( \
          suite##_##name##_body, #suite);                                                 \
  void CAIRN_TEST_CLASS(suite, name)::TestBody()

#define INSTANTIATE_TEST_SUITE_P(prefix, suite, ...)                                         \
  static const auto prefix##_##suite##_values = ::testing::internal::values_of(__VA_ARGS__); \
  static ::testing::internal::Parameterised<suite>::List prefix##_##suite##_list{            \
      prefix##_##suite##_values.data(), static_cast<int>(prefix##_##suite##_values.size()),  \
      nullptr};                                                                              \
  static const bool prefix##_##suite##_added =                                               \
      ::testing::internal::Parameterised<suite>::add_list(prefix##_##suite##_list)

#define CAIRN_TEST_FAILURE(text, fatal) \
  ::testing::internal::Void{} & ::testing::internal::Failure(__FILE__, __LINE__, text, fatal)
#define CAIRN_TEST_EXPECT(good, text) \
  switch (0)                          \
  case 0:                             \
  default:                            \
    if (good)                         \
      ;                               \
    else                              \
      CAIRN_TEST_FAILURE(text, false)
#define CAIRN_TEST_ASSERT(good, text) \
  switch (0)                          \
  case 0:                             \
  default:                            \
    if (good)                         \
      ;                               \
    else                              \
      return CAIRN_TEST_FAILURE(text, true)
/// Each operand is evaluated once.
#define CAIRN_TEST_COMPARE(a, op, b)                              \
  [](const auto& left, const auto& right) {                       \
    return ::testing::internal::show(left op right, left, right); \
  }(a, b)

#define EXPECT_TRUE(x) CAIRN_TEST_EXPECT(static_cast<bool>(x), #x)
#define EXPECT_FALSE(x) CAIRN_TEST_EXPECT(!static_cast<bool>(x), "not " #x)
#define EXPECT_EQ(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, ==, b), #a " == " #b)
#define EXPECT_NE(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, !=, b), #a " != " #b)
#define EXPECT_LT(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, <, b), #a " < " #b)
#define EXPECT_LE(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, <=, b), #a " <= " #b)
#define EXPECT_GT(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, >, b), #a " > " #b)
#define EXPECT_GE(a, b) CAIRN_TEST_EXPECT(CAIRN_TEST_COMPARE(a, >=, b), #a " >= " #b)
#define EXPECT_NEAR(a, b, d) CAIRN_TEST_EXPECT(::testing::internal::near(a, b, d), #a " near " #b)
#define EXPECT_FLOAT_EQ(a, b) \
  CAIRN_TEST_EXPECT(::testing::internal::almost_equal<float>(a, b), #a " almost " #b)
#define EXPECT_DOUBLE_EQ(a, b) \
  CAIRN_TEST_EXPECT(::testing::internal::almost_equal<double>(a, b), #a " almost " #b)
#define ASSERT_TRUE(x) CAIRN_TEST_ASSERT(static_cast<bool>(x), #x)
#define ASSERT_FALSE(x) CAIRN_TEST_ASSERT(!static_cast<bool>(x), "not " #x)
#define ASSERT_EQ(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, ==, b), #a " == " #b)
#define ASSERT_NE(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, !=, b), #a " != " #b)
#define ASSERT_LT(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, <, b), #a " < " #b)
#define ASSERT_LE(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, <=, b), #a " <= " #b)
#define ASSERT_GT(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, >, b), #a " > " #b)
#define ASSERT_GE(a, b) CAIRN_TEST_ASSERT(CAIRN_TEST_COMPARE(a, >=, b), #a " >= " #b)
#define ASSERT_NEAR(a, b, d) CAIRN_TEST_ASSERT(::testing::internal::near(a, b, d), #a " near " #b)
#define ADD_FAILURE() CAIRN_TEST_FAILURE("no failure", false)
#define FAIL() return CAIRN_TEST_FAILURE("no failure", true)
