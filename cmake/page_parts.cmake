# The files of the page as strings of the program. Run as:
#   cmake -DTHREE=.. -DCONTROLS=.. -DPAGE=folder -DOUT=file -P page_parts.cmake
# THREE and CONTROLS may be missing: the program then has no page and says what to install.
set(text "#include \"viz_export/view/page.h\"\n\nnamespace epafi {\nnamespace {\n\n")
function(add_part name content)
  string(FIND "${content}" ")page_part\"" ends)
  if(NOT ends EQUAL -1)
    message(FATAL_ERROR "page part ${name} holds its own ending")
  endif()
  set(text "${text}constexpr char ${name}[] = R\"page_part(${content})page_part\";\n" PARENT_SCOPE)
endfunction()
foreach(part three controls)
  string(TOUPPER ${part} variable)
  set(content "")
  if(${variable} AND EXISTS "${${variable}}")
    file(READ "${${variable}}" content)
  endif()
  add_part(${part} "${content}")
endforeach()
file(READ ${PAGE}/style.css content)
add_part(style "${content}")
file(READ ${PAGE}/index.html content)
add_part(frame "${content}")
set(script "")
foreach(file unpack source camera colours shaders bodies lines pick plots panel viewer follow picked main)
  file(READ ${PAGE}/${file}.js content)
  string(APPEND script "${content}\n")
endforeach()
add_part(script "${script}")
file(WRITE ${OUT} "${text}
}  // namespace

const PageParts& page_parts() {
  static const PageParts parts{three, controls, style, script, frame};
  return parts;
}

}  // namespace epafi
")
