// --limit max_configurations=3
agent A {
  region Lamp { initial mode Off { after 1 -> On }  mode On { after 1 -> Off } }
  region Motion { initial mode Go { after 3 -> Stay }  mode Stay { after 3 -> Go } }
}
