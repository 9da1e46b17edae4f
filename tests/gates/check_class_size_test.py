#!/usr/bin/env python3
"""check_class_size.py counts what is private, a function, and a member, and refuses a class with too many."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import check_class_size as check

SAMPLE = """
#include <x>
namespace a {
class Forward;
enum class Kind : int { kOne };
template <class T, int N = (2 + 3)>
class Large : public Base<T> {
  int first(int a) const { return a == 2 ? f(a) : 3; }

 public:
  explicit Large(int n = 3) : n_(n), m_{n} {}
  void open();
  struct Inner {
    int f() const { return 1; }
   private:
    int hidden();
  };

 private:
  // void commented();
  template <class Scene>
  static bool second(const Scene& scene, float x = g(2.0F));
  Large& operator=(const Large& other);
  __attribute__((noinline)) bool third(int* p);
  friend class Other;
  static_assert(sizeof(int) == 4, "text; {");
  using Pointer = void (*)(int);
  static constexpr int kSize = f(3);
  int n_ = g(4);
  int m_{2};
  Array<sizeof(T)> array_;
  int table_[2] = {1, 2};
};
struct Open {
  void f();
  void g() {}
};
template <class T>
bool Large<T>::second(const Scene& scene, float x) { return f(x); }
}  // namespace a
"""


class ClassSize(unittest.TestCase):
    def test_counts_private_member_functions(self):
        self.assertEqual(check.classes(check.plain(SAMPLE)), {"Large": 4, "Large::Inner": 1, "Open": 0})

    def run_on(self, limit, text):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "sample.hpp").write_text(text)
            with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
                return check.main([str(limit), folder]), out.getvalue()

    def test_refuses_a_class_with_too_many(self):
        status, text = self.run_on(3, SAMPLE)
        self.assertEqual(status, 1)
        self.assertIn("Large has 4 private member functions, at most 3", text)

    def test_passes_at_the_limit(self):
        self.assertEqual(self.run_on(4, SAMPLE)[0], 0)

    def test_refuses_a_limit_that_has_become_too_high(self):
        status, text = self.run_on(5, SAMPLE)
        self.assertEqual(status, 1)
        self.assertIn("lower the limit of 5", text)

    def test_refuses_to_look_at_nothing(self):
        self.assertEqual(self.run_on(4, "")[0], 2)
        self.assertEqual(self.run_on("many", SAMPLE)[0], 2)


if __name__ == "__main__":
    unittest.main()
