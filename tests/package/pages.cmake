# Links of all pages, the counts of the style page, and the scenes that docs/coming_from.md shows.
find_program(EPAFI_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(EPAFI_SYSTEM_PYTHON)
  set(pages ${EPAFI_SYSTEM_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/package/pages.py)
  add_test(NAME "links of all pages lead somewhere" COMMAND ${pages} links)
  set_tests_properties("links of all pages lead somewhere" PROPERTIES LABELS "fast;documents")
  add_test(NAME "counts of the style page hold"
    COMMAND ${EPAFI_SYSTEM_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/package/style.py)
  set_tests_properties("counts of the style page hold" PROPERTIES LABELS "fast;documents")
  add_test(NAME "the table of mutants fits the sources"
    COMMAND ${EPAFI_SYSTEM_PYTHON} ${PROJECT_SOURCE_DIR}/tests/mutants/run.py ${PROJECT_SOURCE_DIR} --check)
  set_tests_properties("the table of mutants fits the sources" PROPERTIES LABELS fast)
  add_test(NAME "tables of the pages hold the figures of figures.csv"
    COMMAND ${EPAFI_SYSTEM_PYTHON} ${PROJECT_SOURCE_DIR}/tools/figures.py --check)
  set_tests_properties("tables of the pages hold the figures of figures.csv" PROPERTIES LABELS "fast;documents")
  if(TARGET epafi)
    add_test(NAME "scenes for users of other programs are accepted" COMMAND ${pages} scenes $<TARGET_FILE:epafi>)
    set_tests_properties("scenes for users of other programs are accepted" PROPERTIES LABELS "fast;documents")
  endif()
endif()
